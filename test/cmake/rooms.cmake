# The rooms of the three algorithms: who may include whom. Read by check_include_rules.cmake; the page
# doc/user_manual/architecture.md shows it as figures.
#
# A header in include/pcs/<algorithm>/<room>/ may include its own room, <algorithm>/model/, the levels below, and the
# doors that are listed here for its room, as <room>/<header> or as <room> for all headers of a room. Headers directly
# in <algorithm>/ (the session) and the public headers at the top may include what `<algorithm>_session` and `root` list.

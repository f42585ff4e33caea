s/\\cite ([A-Za-z0-9_]+)/\\ref bib_\1 "[\1]"/g

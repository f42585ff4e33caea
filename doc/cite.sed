s/\\cite ([A-Za-z0-9_]+)/\\ref bib_\1 "[\1]"/g
# Doxygen resolves no headings of Markdown pages: links within a page become text, others lead to the page.
s/\[([^]]*)\]\(#[^)]*\)/\1/g
s/(\]\([^)#]*\.md)#[^)]*\)/\1)/g

"""Writers: a page as HTML, LaTeX, Markdown, Typst and PDF."""

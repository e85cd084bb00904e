"""What the HTML pages share: style and tables."""

from __future__ import annotations

import html

STYLE = """body{font:15px/1.5 system-ui,sans-serif;max-width:1180px;margin:2em auto;padding:0 1em;color:#222}
h1{margin-bottom:0}h2{margin-top:2em;border-bottom:1px solid #ddd}table{border-collapse:collapse;margin:.5em 0}
td,th{padding:.2em .8em;border-bottom:1px solid #eee;text-align:left}td.n,th.n{text-align:right;font-variant-numeric:tabular-nums}
.row{display:flex;flex-wrap:wrap;gap:8px}.row figure{margin:0}
figcaption{font-size:13px;color:#555}img{max-height:420px;max-width:100%}
svg{max-width:100%;height:auto}"""


def table(header: list[str], rows: list[list]) -> str:
    def cell(value, tag):
        number = isinstance(value, (int, float))
        text = f"{value:.4g}" if isinstance(value, float) else str(value)
        return f"<{tag}{' class=n' if number else ''}>{html.escape(text)}</{tag}>"

    head = "".join(cell(h, "th") for h in header)
    body = "".join("<tr>" + "".join(cell(c, "td") for c in row) + "</tr>" for row in rows)
    return f"<table><tr>{head}</tr>{body}</table>"

"""What the HTML pages share: head, style and tables."""

from __future__ import annotations

import html

STYLE = """body{font:15px/1.5 system-ui,sans-serif;max-width:1180px;margin:2em auto;padding:0 1em;color:#222}
h1{margin-bottom:0}h2{margin-top:2em;border-bottom:1px solid #ddd}table{border-collapse:collapse;margin:.5em 0}
td,th{padding:.2em .8em;border-bottom:1px solid #eee;text-align:left}td.n,th.n{text-align:right;font-variant-numeric:tabular-nums}
.wide{overflow-x:auto}.wide td:last-child{overflow-wrap:anywhere}.row{display:flex;flex-wrap:wrap;gap:8px}.row figure{margin:0}
figcaption{font-size:13px;color:#555}img{max-height:420px;max-width:100%}
svg{max-width:100%;height:auto}.wide svg{min-width:480px}.doubt{color:#a40}
@media(max-width:600px){body{margin:1em auto;padding:0 .7em}td,th{padding:.2em .4em}}"""


def page(title: str, body: str, head: str = "") -> str:
    """A whole document, as wide as the screen that shows it."""
    fits = '<meta name="viewport" content="width=device-width,initial-scale=1">'
    title = f"<title>{html.escape(title)}</title><style>{STYLE}</style>"
    return f'<!doctype html><html lang="en"><meta charset="utf-8">{fits}{head}{title}{body}</html>\n'


def shown(value) -> str:
    """A value of a summary in words: numbers to four digits, what is listed with commas."""
    if isinstance(value, dict):
        return ", ".join(f"{name}: {shown(inner)}" for name, inner in value.items()) or "none"
    if isinstance(value, (list, tuple)):
        return ", ".join(shown(inner) for inner in value) or "none"
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def table(header: list[str], rows: list[list]) -> str:
    """Scrolls by itself where it is wider than the page."""

    def cell(value, tag):
        number = isinstance(value, (int, float))
        return f"<{tag}{' class=n' if number else ''}>{html.escape(shown(value))}</{tag}>"

    head = "".join(cell(h, "th") for h in header)
    body = "".join("<tr>" + "".join(cell(c, "td") for c in row) + "</tr>" for row in rows)
    return f'<div class="wide"><table><tr>{head}</tr>{body}</table></div>'

"""viser's page in our words, colours and light: its own are called Viser, too pale for WCAG AA, and slow."""

import gzip
from functools import lru_cache
from typing import Final

from websockets.http11 import Response

NAMED: Final = (
    b"<script>new MutationObserver(()=>{"
    b"const bare=':not([aria-label]:not([aria-label=\"\"]))',all=what=>document.querySelectorAll(what+bare);"
    b"for(const each of all('button:not([aria-hidden=true])'))if(!each.textContent.trim())"
    b"each.setAttribute('aria-label',/close/i.test(each.className)?'Close':'Connection and scene');"
    b"for(const each of [...all('input:not([type=file])'),...all('[role=slider]')]){"
    b"if(each.labels?.length)continue;"
    b"let near=each;while(near&&!near.querySelector('label'))near=near.parentElement;"
    b"each.setAttribute('aria-label',near?.querySelector('label').textContent||'value')}"
    b"}).observe(document,{childList:true,subtree:true})</script>"
)
"""Buttons of viser's that are pictures alone, its sliders and numbers have no name that could be read out."""

TITLE: Final = b"<title>sdt: kitchens, robots and verdicts in 3D</title>"
STYLE: Final = (
    b"<style>:root{--mantine-color-dimmed:#50575e!important;--mantine-color-gray-6:#50575e!important;"
    b"--mantine-color-blue-6:#0b4f86!important;--mantine-color-blue-7:#0a4678!important}"
    b":focus-visible{outline:3px solid #0b4f86!important;outline-offset:2px}"
    b".mantine-NumberInput-input{min-height:24px!important}"
    b".mantine-Checkbox-input{width:24px!important;height:24px!important}"
    b".mantine-Checkbox-inner{width:24px!important;height:24px!important}"
    b".mantine-Slider-thumb::after{content:'';position:absolute;inset:-9px}</style>"
)
"""Greys and blues of 3.3 and 3.6 : 1 on white become such of 7.3 and 8.4 : 1; what is hit has 24 px,
as WCAG 2.2 AA asks, but for the arrows of numbers, which can be typed as well."""
UNLIT: Final = (
    b"<script>{const ask=fetch;globalThis.fetch=(what,...more)=>"
    b"String(what?.url??what).startsWith('data:image/jpeg')?new Promise(()=>{}):ask(what,...more)}</script>"
)
"""viser's client decodes a picture of a city to light the scene with, before it hears of other light: a sixth
of what a browser without a graphics card computes until the page is ready. It waits for it in vain."""


def dressed(response: Response) -> None:
    """The page has our title and colours; other answers are as they were."""
    if not response.headers.get("Content-Type", "").startswith("text/html"):
        return
    response.body = _dressed(bytes(response.body), response.headers.get("Content-Encoding") == "gzip")
    del response.headers["Content-Length"]
    response.headers["Content-Length"] = str(len(response.body))


@lru_cache(maxsize=4)
def _dressed(body: bytes, packed: bool) -> bytes:
    page = gzip.decompress(body) if packed else body
    page = page.replace(b"<title>Viser</title>", TITLE + STYLE + NAMED + UNLIT, 1)
    return gzip.compress(page, compresslevel=1) if packed else page

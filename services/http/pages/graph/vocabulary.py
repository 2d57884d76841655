"""The ontology as one page, as `sdt ontology` writes it."""

import asyncio
import hashlib
import re
from base64 import b64encode
from functools import cache

from starlette.requests import Request
from starlette.responses import HTMLResponse, Response

from services.ontology_page.page import page


async def ontology_page(request: Request) -> Response:
    """The page; its own style is allowed by its hash, and nothing else."""
    del request
    text, policy = await asyncio.to_thread(_made)
    return HTMLResponse(text, 200, {"Content-Security-Policy": policy})


@cache
def _made() -> tuple[str, str]:
    """The page and the policy that fits it."""
    text = page()
    styles = re.findall(r"<style>(.*?)</style>", text, re.DOTALL)
    hashes = [b64encode(hashlib.sha256(each.encode()).digest()).decode() for each in styles]
    allowed = " ".join(f"'sha256-{each}'" for each in hashes)
    return text, f"default-src 'none'; style-src {allowed}; frame-ancestors 'none'; base-uri 'none'"

"""What the page of the twin shows is true: its Python runs, one block after the other."""

import re
from pathlib import Path
from typing import Any

import sdt_kg

PAGE = (Path(sdt_kg.__file__).parent / "README.md").read_text(encoding="utf-8")
CODE = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)


def test_the_python_of_the_page_runs() -> None:
    assert len(CODE) == 2
    names: dict[str, Any] = {}
    for block in CODE:
        exec(compile(block, "sdt_kg/README.md", "exec"), names)  # noqa: S102 - our own page
    (opened,) = names["history"].select("when_opened", names["opened"], container=names["door"].iri)
    assert (opened["sample"], opened["time"]) == (19, 9.5)
    assert names["history"].at(names["opened"], 17).state[names["door"].active_joint] == 1.32

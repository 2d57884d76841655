"""A notebook's cells run in this process, without a kernel: what each cell shows, as HTML."""

import ast

from services.reports.pages.figure import Figure
from services.reports.run.catalogue import PARAMETERS, Value, notebook


def run(name: str, **values: Value) -> list[str]:
    """What the code cells show, in their order; an error of a cell is raised as it is."""
    known, shown = dict[str, object](), list[str]()
    code = [cell for cell in notebook(name).node.cells if cell.cell_type == "code"]
    for cell in code:
        body = ast.parse(cell.source).body
        last = body.pop() if isinstance(body[-1], ast.Expr) else None
        exec(compile(ast.Module(body, []), name, "exec"), known)  # noqa: S102 - our own notebook
        if PARAMETERS in cell.metadata.get("tags", []):
            unknown = values.keys() - known.keys()
            assert not unknown, f"{name} has no {unknown}"
            known.update(values)
        if last is not None:
            shown.append(html_of(eval(compile(ast.Expression(last.value), name, "eval"), known)))  # noqa: S307
    return shown


def html_of(shown: object) -> str:
    """As Jupyter asks for it; of a figure, which takes its time to draw, the caption alone."""
    if isinstance(shown, Figure):
        return shown.caption
    if hasattr(shown, "_repr_mimebundle_"):
        return shown._repr_mimebundle_()["text/html"]
    return shown._repr_html_()

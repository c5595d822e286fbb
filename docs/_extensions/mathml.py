"""Mathematics as MathML, which browsers draw in the colour of the text: no script, no network."""

from docutils import nodes
from docutils.utils.math.latex2mathml import tex2mathml


def setup(app) -> dict[str, bool]:
    """Let Sphinx write every formula with docutils' own converter."""
    app.add_html_math_renderer(
        "mathml", inline_renderers=(_inline, None), block_renderers=(_block, None)
    )
    return {"parallel_read_safe": True}


def _inline(writer, node: nodes.math) -> None:
    writer.body.append(tex2mathml(node.astext(), as_block=False))
    raise nodes.SkipNode


def _block(writer, node: nodes.math_block) -> None:
    writer.body.append(f'<div class="math">{tex2mathml(node.astext(), as_block=True)}</div>')
    raise nodes.SkipNode

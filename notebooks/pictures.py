"""How the notebooks show images: no physics, only matplotlib."""

import matplotlib.pyplot as plt
import numpy as np


def polar(axes, image, title, value=None, **options):
    """An image over azimuth (degrees, right is right) and range (metres, far is up)."""
    where = image.axes
    extent = [*np.degrees(where.beam_edges_rad[[0, -1]]), where.range_min_m, where.range_max_m]
    options = {"cmap": "gray", "vmin": 0, "vmax": image.full_scale, **options}
    shown = axes.imshow(image.value if value is None else value, extent=extent, origin="lower", aspect="auto",
                        interpolation="nearest", **options)
    axes.set(title=title, xlabel="azimuth, degrees", ylabel="range, m")
    return shown


def fan(axes, image, title, **options):
    """The same laid out in metres, as the sonar's screen shows it."""
    laid_out = image.fan()
    value = np.where(laid_out.inside, laid_out.value, np.nan)
    options = {"cmap": "gray", "vmin": 0, "vmax": image.full_scale, **options}
    axes.imshow(value, extent=laid_out.extent_m, interpolation="nearest", **options)
    axes.set(title=title, xlabel="x to the right, m", ylabel="y ahead, m")


def side_by_side(images, show=polar, width=4.0, height=4.2):
    """A row of pictures: {title: image}."""
    figure, panels = plt.subplots(1, len(images), figsize=(width * len(images), height), squeeze=False)
    for panel, (title, image) in zip(panels[0], images.items()):
        show(panel, image, title)
    figure.tight_layout()
    plt.show()


def table(rows, header):
    """Rows of text or numbers as a table that a notebook shows."""
    from IPython.display import HTML, display

    def cell(value):
        return f"{value:.3g}" if isinstance(value, float) else "-" if value is None else str(value)

    lines = "".join("<tr>" + "".join(f"<td>{cell(value)}</td>" for value in row) + "</tr>" for row in rows)
    display(HTML("<table><tr>" + "".join(f"<th>{name}</th>" for name in header) + f"</tr>{lines}</table>"))

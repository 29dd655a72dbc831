"""The 3-D view of a report: its scene, and the scripts that show it, all of which go into the page.

The library is three.js as Debian packages it; it is read from there when a report is made.
"""
import json
from pathlib import Path
from typing import Any, Dict, Optional

from .frames import Frames
from .scene import scene

HERE = Path(__file__).parent
OWN = ("view_world.js", "view.js")
FOLDERS = (Path("/usr/share/javascript/three"), Path("/usr/share/nodejs/three"))      # where Debian's package has it
LIBRARY, ORBIT = ("three.min.js", "build/three.min.js"), "examples/js/controls/OrbitControls.js"
PACKAGE = "libjs-three"
# of the library, whose packaged file has lost it
LICENCE = """\
/* three.js, copyright 2010 the three.js authors, under the MIT licence:
Permission is hereby granted, free of charge, to any person obtaining a copy of this software and associated
documentation files (the "Software"), to deal in the Software without restriction, including without limitation the
rights to use, copy, modify, merge, publish, distribute, sublicense, and/or sell copies of the Software, and to permit
persons to whom the Software is furnished to do so, subject to the following conditions: The above copyright notice
and this permission notice shall be included in all copies or substantial portions of the Software.
THE SOFTWARE IS PROVIDED "AS IS", WITHOUT WARRANTY OF ANY KIND, EXPRESS OR IMPLIED, INCLUDING BUT NOT LIMITED TO THE
WARRANTIES OF MERCHANTABILITY, FITNESS FOR A PARTICULAR PURPOSE AND NONINFRINGEMENT. IN NO EVENT SHALL THE AUTHORS OR
COPYRIGHT HOLDERS BE LIABLE FOR ANY CLAIM, DAMAGES OR OTHER LIABILITY, WHETHER IN AN ACTION OF CONTRACT, TORT OR
OTHERWISE, ARISING FROM, OUT OF OR IN CONNECTION WITH THE SOFTWARE OR THE USE OR OTHER DEALINGS IN THE SOFTWARE. */
"""


def make_view_content(data, ground, section, frames: Optional[Frames], why: str, film: str) -> Dict[str, Any]:
    """What the template takes: scene (JSON) and scripts, with a caption, or why there is none; and film, a sentence."""
    content: Dict[str, Any] = {"title": "The collapse in three dimensions", "scene": None, "scripts": [], "why": why,
                               "caption": "", "film": film}
    if frames is None:
        return content
    scripts = library()
    if scripts is None:
        return {**content, "why": f"It needs the JavaScript library three.js: install the Debian package {PACKAGE} and "
                                  "make the report again."}
    about = scene(data, ground, section, frames)
    # in a script element, only the end of an element must not stand in a text
    return {**content, "scene": json.dumps(about, separators=(",", ":"), allow_nan=False).replace("</", "<\\/"),
            "scripts": scripts, "caption": caption(data, about, frames)}


def library():
    """The scripts of the page, in their order; None where the library is not installed."""
    for folder in FOLDERS:
        path = next((folder / name for name in LIBRARY if (folder / name).is_file()), None)
        if path and (folder / ORBIT).is_file():
            texts = [LICENCE + path.read_text(encoding="utf-8"), (folder / ORBIT).read_text(encoding="utf-8")]
            return [text.replace("</script", "<\\/script")
                    for text in texts + [(HERE / name).read_text(encoding="utf-8") for name in OWN]]
    return None


def caption(data, scene_, frames: Frames) -> str:
    """What is seen, what was left out, and what is drawn between the snapshots."""
    shown, times = scene_["balls"]["count"], len(scene_["times"])
    balls = f"All {shown:,} balls" if frames.factor == 1 else \
        (f"{shown:,} of the {frames.balls:,} balls, chosen at random; each stands for {frames.factor:.3g} and is drawn "
         f"with their volume, {frames.factor ** (1 / 3):.2g} times as wide")
    every = f"all {times} snapshots" if times == frames.dumped else f"{times} of the {frames.dumped} snapshots"
    left_out = [one["name"] for one in scene_["structures"] if not one["triangles"]]
    walls = f" Not drawn, for its size: {', '.join(left_out)}." if left_out else ""
    gap = (frames.time[-1] - frames.time[0]) / max(1, times - 1)
    run = f"Run: {data.label(data.result)}. " if data.study else ""
    return (f"{run}{balls}, at {every} that the run wrote, {gap:.2g} s apart on average; between two of them each ball "
            f"is drawn on a straight line. The ground is the one without the body, so that the slip surface shows; "
            f"heights are not exaggerated; contours every {scene_['ground']['interval']:g} m, grid of "
            f"{scene_['ground']['grid']:g} m. Drag turns the view, with the right button it moves, the wheel zooms "
            f"after a click. The scale bar is valid at the centre of the view.{walls}")

#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Opens a STEP file in FreeCAD's window and saves what one sees. Needs freecad, xvfb and xauth.

usage: freecad_screenshot.py FILE.step OUT.png
Exit 0 if the picture was written, 1 if not. FreeCAD runs with a home folder of its own, so nobody's settings change.
"""
import os
import pathlib
import subprocess
import sys
import tempfile

SIZE = "1280x800x24"
LIMIT_S = 300

# The start page needs a web engine that does not run as root: begin in another workbench.
SETTINGS = """<?xml version="1.0" encoding="UTF-8" standalone="no" ?>
<FCParameters><FCParamGroup Name="Root"><FCParamGroup Name="BaseApp"><FCParamGroup Name="Preferences"><FCParamGroup Name="General">
<FCText Name="AutoloadModule">PartWorkbench</FCText>
</FCParamGroup></FCParamGroup></FCParamGroup></FCParamGroup></FCParameters>
"""

# Runs inside FreeCAD once its window stands.
INSIDE = """
import os
import FreeCAD, FreeCADGui, Part
from PySide import QtCore, QtGui

def finish():  # the screen, because a grab of the window lacks what OpenGL draws
    ok = QtGui.QGuiApplication.primaryScreen().grabWindow(0).save(os.environ["MESO_PICTURE"])
    os._exit(0 if ok else 1)

def look():
    view = FreeCADGui.activeDocument().activeView()
    view.viewTrimetric()  # an isometric view looks along the struts of cubic cells
    view.fitAll()
    QtCore.QTimer.singleShot(2000, finish)

def start():
    try:
        window = FreeCADGui.getMainWindow()
        window.showMaximized()
        for panel in window.findChildren(QtGui.QDockWidget):
            panel.setVisible(panel.objectName() == "Combo View")
        document = FreeCAD.newDocument("part")
        shape = Part.Shape()
        shape.read(os.environ["MESO_STEP"])
        item = document.addObject("Part::Feature", "Lattice")
        item.Shape = shape
        item.ViewObject.DisplayMode = "Shaded"
        item.ViewObject.Deviation = 1.0
        document.recompute()
        QtCore.QTimer.singleShot(2000, look)
    except Exception as error:
        print(error, flush=True)
        os._exit(1)

QtCore.QTimer.singleShot(1500, start)
"""


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    step, picture = (str(pathlib.Path(name).resolve()) for name in sys.argv[1:])
    with tempfile.TemporaryDirectory() as home:
        folder = pathlib.Path(home)
        (folder / ".config/FreeCAD").mkdir(parents=True)
        (folder / ".config/FreeCAD/user.cfg").write_text(SETTINGS)
        script = folder / "meso_screenshot.py"
        script.write_text(INSIDE)
        environment = {**os.environ, "HOME": home, "LIBGL_ALWAYS_SOFTWARE": "1", "MESO_STEP": step, "MESO_PICTURE": picture}
        command = ["timeout", "-k", "5", str(LIMIT_S), "xvfb-run", "-a", "-s", f"-screen 0 {SIZE} +extension GLX", "freecad", str(script)]
        code = subprocess.run(command, env=environment, stdin=subprocess.DEVNULL).returncode
    sys.exit(0 if code == 0 and pathlib.Path(picture).is_file() else 1)


if __name__ == "__main__":
    main()

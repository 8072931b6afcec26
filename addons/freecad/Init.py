# Run by FreeCAD at its start, with and without a screen: the post-processor "camber" is found in this folder.
import os


def _find_posts_here():
    import camber_freecad

    here = os.path.dirname(os.path.dirname(os.path.realpath(camber_freecad.__file__)))
    try:
        from camber_freecad import compat

        preferences = compat.preferences()
    except ImportError:  # FreeCAD without its Path (CAM) workbench
        return
    others = preferences.searchPathsPost

    def search_paths():
        paths = others()
        return paths if here in paths else paths + [here]

    preferences.searchPathsPost = search_paths


_find_posts_here()

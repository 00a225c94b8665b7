"""`plotter.mcvr`: the volumes of a plotter by light transport.

Found by the entry point group `pyvista.plotter_components`; nothing heavy is imported before
`enable`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pyvista as pv

if TYPE_CHECKING:
    from ..live import LiveSettings, LiveWindow
    from ..pictures.noiseless import NoiselessPicture
    from ..pictures.picture import Picture
    from .driver import Driver
    from .tools import FocusPicking

# Backends of PyVista in a notebook that show what the server renders
SERVED = ("trame", "server")


@pv.register_plotter_component("mcvr")
class PlotterComponent:
    """Physically based light for the volumes of a plotter.

    Parameters
    ----------
    plotter : pyvista.Plotter

    Examples
    --------
    >>> plotter = pyvista.Plotter()
    >>> plotter.add_volume(image, cmap="bone", opacity="sigmoid", shade=True)
    >>> plotter.mcvr.enable(nrms=0.02)
    >>> plotter.show()
    """

    def __init__(self, plotter: pv.Plotter) -> None:
        self._plotter = plotter
        self._live: LiveWindow | None = None
        self._settings: LiveSettings | None = None
        self._progressive: bool | None = None
        self._driver: Driver | None = None
        self._picking: FocusPicking | None = None

    @property
    def enabled(self) -> bool:
        """Whether this package draws the volumes."""
        return self._live is not None

    def enable(self, *, progressive: bool | None = None, **settings: Any) -> PlotterComponent:
        """Draw every volume of the plotter, in all its subplots, by light transport.

        Camera, lights, environment texture, background, clipping and each volume's own transfer
        function stay the plotter's; a change of any of them starts the picture anew. Volumes that
        are added later are drawn too. Called again, it changes the settings that are given.

        Parameters
        ----------
        progressive : bool, optional
            Refine pictures from frame to frame. Default: in an interactive window and in a page
            served by trame; off screen, each picture is finished before it is shown.
        **settings
            Of `vtkmcvr.live.LiveSettings`: technique, samples, nrms, seconds, lighting, meshes,
            scattering, lens, exposure, text, seed, threads ...

        Raises
        ------
        TypeError, ValueError
            For a setting that does not exist or is not allowed, and for volumes that cannot be
            rendered: other grids than ImageData, other blending than composite.
        """
        from dataclasses import replace

        from ..live import LiveSettings, LiveWindow
        from .driver import Driver

        wanted = replace(self._settings or LiveSettings(), **settings)
        if self._plotter.render_window is None:
            raise RuntimeError("the plotter is closed: enable before show(), or auto_close=False")
        self._progressive = progressive if progressive is not None else self._progressive
        if self._live is None:
            live = LiveWindow(
                self._plotter.render_window, self._plotter.renderers, wanted, self._is_progressive
            )
            try:
                live.check()
            except BaseException:
                live.close()
                raise
            self._live, self._driver = live, Driver(self._plotter, live, self._is_progressive)
        else:
            self._live.change(wanted)
        self._settings = wanted
        return self

    def disable(self) -> None:
        """Leave the volumes to VTK again; everything is as it was before `enable`."""
        if self._live is not None:
            assert self._driver is not None
            self._driver.close()
            self._live.close()
            self._live = self._settings = self._driver = None
        if self._picking is not None:
            self._picking.close()
            self._picking = None

    @property
    def settings(self) -> LiveSettings:
        """How the volumes are drawn."""
        self._enabled()
        assert self._settings is not None
        return self._settings

    @property
    def picture(self) -> Picture | NoiselessPicture:
        """Picture of the active subplot's volumes so far: float radiance, errors, plan."""
        view = self._view()
        if view.job is None:
            raise RuntimeError("there is no picture yet: show the plotter first")
        return view.job.picture()

    @property
    def samples(self) -> int:
        """Samples per pixel so far, of the active subplot."""
        shown = self._view().shown
        return 0 if shown is None else shown.samples

    @property
    def error(self) -> float:
        """Estimated NRMS error so far, of the active subplot; inf while it is unknown."""
        shown = self._view().shown
        return float("inf") if shown is None else shown.error

    @property
    def done(self) -> bool:
        """Whether the picture of the active subplot has reached its target."""
        shown = self._view().shown
        return shown is not None and shown.done

    def wait(self, timeout: float | None = None) -> bool:
        """Wait until all pictures are done, and draw them; False after `timeout` seconds."""
        return self._enabled().wait(timeout)

    def add_light_widget(self, position: Any = None, *, intensity: float = 1.0) -> pv.Light:
        """Add a lamp with a handle that the mouse drags; see `tools.add_light_widget`."""
        from .tools import add_light_widget

        self._enabled()
        return add_light_widget(self._plotter, position, intensity)

    def add_opacity_editor(self, volume: Any = None) -> pv.Chart2D:
        """Add a chart whose points the mouse drags: opacity; see `tools.add_opacity_editor`."""
        from .tools import add_opacity_editor

        self._enabled()
        return add_opacity_editor(self._plotter, volume)

    def focus_at(self, column: int, row: int, aperture: float) -> float:
        """Make what is seen in a pixel sharp, and blur what is nearer or further.

        Parameters
        ----------
        column, row : int
            Of the active subplot, from its upper left corner.
        aperture : float
            Radius of the lens, world units, > 0.

        Returns
        -------
        float
            Distance of the focal plane along the view axis.
        """
        return self._focus(self._view(), column, row, aperture)

    def enable_focus_picking(self, aperture: float, *, button: str = "right") -> None:
        """Focus on what is clicked, until `disable`.

        Parameters
        ----------
        aperture : float
            Radius of the lens, world units, > 0.
        button : {"left", "middle", "right"}
        """
        from .tools import FocusPicking

        live = self._enabled()

        def focus(renderer: Any, column: int, row: int) -> None:
            for view in live.views:
                if view.renderer is renderer:
                    self._focus(view, column, row, aperture)

        self._picking = FocusPicking(self._plotter, focus, button)

    def __plotter_close__(self) -> None:
        """Let go of the plotter; called by PyVista."""
        self.disable()

    def _enabled(self) -> LiveWindow:
        if self._live is None:
            raise RuntimeError("call plotter.mcvr.enable() first")
        return self._live

    def _view(self) -> Any:
        live, active = self._enabled(), self._plotter.renderer
        return next(view for view in live.views if view.renderer is active)

    def _focus(self, view: Any, column: int, row: int, aperture: float) -> float:
        from ..camera import Lens
        from .tools import focus_distance

        distance = focus_distance(view.job, column, row)
        self.enable(lens=Lens(aperture, distance))
        return distance

    def _is_progressive(self) -> bool:
        plotter = self._plotter
        if self._progressive is not None:
            return self._progressive
        if plotter.mwriter is not None:
            # Each frame of a movie is finished
            return False
        served = plotter.notebook and pv.global_theme.jupyter_backend in SERVED
        return bool(served or not plotter.off_screen)

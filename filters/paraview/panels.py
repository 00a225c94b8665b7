"""Property panels of the ParaView plugin, in the server manager's XML."""

from __future__ import annotations

from vtkmcvr.presets import LOOKS

# What a picture is made with where it is not a preset
VIEW = "Active View"
CAMERAS = ("Active View", "Values Below", "Whole Volume")
LIGHTS = ("Studio", "Active View")


def number(
    name: str,
    label: str,
    default: str,
    help: str,
    *,
    least: str,
    most: str = "",
    whole: bool = True,
    advanced: bool = False,
) -> str:
    """Property of one or several numbers with a range."""
    kind, domain = ("Int", "IntRange") if whole else ("Double", "DoubleRange")
    count = len(default.split())
    high = f'max="{most}"' if most else ""
    level = "advanced" if advanced else "default"
    return f"""
    <{kind}VectorProperty name="{name}" label="{label}" command="Set{name}"
      number_of_elements="{count}" default_values="{default}" panel_visibility="{level}">
      <{domain}Domain name="range" min="{least}" {high}/>
      <Documentation>{help}</Documentation>
    </{kind}VectorProperty>"""


def switch(name: str, label: str, help: str) -> str:
    """Property that is on or off; at first it is off."""
    return f"""
    <IntVectorProperty name="{name}" label="{label}" command="Set{name}"
      number_of_elements="1" default_values="0">
      <BooleanDomain name="bool"/>
      <Documentation>{help}</Documentation>
    </IntVectorProperty>"""


def choice(name: str, label: str, entries: tuple[str, ...], help: str) -> str:
    """Property of one of several numbered entries; at first it is the first."""
    listed = "".join(f'<Entry value="{k}" text="{text}"/>' for k, text in enumerate(entries))
    return f"""
    <IntVectorProperty name="{name}" label="{label}" command="Set{name}"
      number_of_elements="1" default_values="0">
      <EnumerationDomain name="enum">{listed}</EnumerationDomain>
      <Documentation>{help}</Documentation>
    </IntVectorProperty>"""


def _vector(name: str, label: str, default: str, help: str) -> str:
    count = len(default.split())
    return f"""
    <DoubleVectorProperty name="{name}" label="{label}" command="Set{name}"
      number_of_elements="{count}" default_values="{default}" panel_visibility="advanced">
      <DoubleRangeDomain name="range"/>
      <Documentation>{help}</Documentation>
    </DoubleVectorProperty>"""


INPUT = """
    <InputProperty name="Input" command="SetInputConnection">
      <ProxyGroupDomain name="groups">
        <Group name="sources"/><Group name="filters"/>
      </ProxyGroupDomain>
      <DataTypeDomain name="input_type"><DataType value="vtkImageData"/></DataTypeDomain>
      <InputArrayDomain name="input_array" number_of_components="1"/>
      <Documentation>The volume.</Documentation>
    </InputProperty>
    <StringVectorProperty name="SelectInputScalars" label="Scalars"
      command="SetInputArrayToProcess" element_types="0 0 0 0 2" number_of_elements="5"
      default_values="0">
      <ArrayListDomain name="array_list" attribute_type="Scalars">
        <RequiredProperties><Property name="Input" function="Input"/></RequiredProperties>
      </ArrayListDomain>
      <Documentation>The array to render.</Documentation>
    </StringVectorProperty>
    <OutputPort index="0" name="Picture"/>
    <OutputPort index="1" name="Statistics"/>
"""

LOOK = f"""
    <StringVectorProperty name="Look" command="SetLook" number_of_elements="1"
      default_values="{VIEW}">
      <StringListDomain name="looks">
        {"".join(f'<String value="{name}"/>' for name in (VIEW, *LOOKS))}
      </StringListDomain>
      <Documentation>Opacity and colour: those of the volume in the active view, where the input is
        shown as Volume, or a preset.</Documentation>
    </StringVectorProperty>
    <Property name="TakeFromView" label="Take From Active View" command="TakeFromView"
      panel_widget="command_button">
      <Documentation>Takes transfer functions, camera and lights of the active view anew; a picture
        does not follow the view by itself.</Documentation>
    </Property>"""

VIEWING = (
    number("FilmSize", "Film Size", "400 300", "Width and height of the picture in pixels.",
           least="1 1", most="16384 16384")
    + choice("Camera", "Camera", CAMERAS, "Where the volume is seen from.")
    + _vector("CameraPosition", "Camera Position", "0 0 1", "World coordinates.")
    + _vector("CameraFocalPoint", "Camera Focal Point", "0 0 0", "World coordinates.")
    + _vector("CameraViewUp", "Camera View Up", "0 1 0", "Direction that is up in the picture.")
    + _vector("CameraViewAngle", "Camera View Angle", "30", "Vertical angle in degrees.")
    + choice("Lights", "Lights", LIGHTS,
             "A key light, a rim light and a fill around the camera, or the view's own lights.")
    + number("GradientFactor", "Surface Share", "0.5",
             "How much of a volume with shading is surfaces, 0 to 1.",
             least="0", most="1", whole=False)
    + number("Exposure", "Exposure", "0", "Stops; +1 doubles the brightness. Traces no ray.",
             least="-20", most="20", whole=False)
    + number("Threads", "Threads", "0", "0: all CPUs. Changes no pixel.", least="0", advanced=True)
)  # fmt: skip


HINTS = """
    <Hints>
      <ShowInMenu category="Volume Rendering"/>
    </Hints>"""

MONTE_CARLO = (
    "<Documentation>Renders a volume by Monte Carlo light transport. The picture has displayed "
    "colours (rgba), linear radiance, depth and standard error; a table tells samples, time and "
    "error.</Documentation>"
    + INPUT
    + LOOK
    + number("Samples", "Samples", "16",
             "Samples per pixel: more are less noise, and go on with the picture.", least="1")
    + number("Seconds", "Seconds", "0", "Time after which the picture ends; 0: no limit.",
             least="0", whole=False)
    + number("Seed", "Seed", "0", "The same seed gives the same picture.", least="0",
             advanced=True)
    + switch("MultipleScattering", "Multiple Scattering",
             "Light scatters many times in the volume, not once.")
    + VIEWING
    + HINTS
)  # fmt: skip

OCCLUSION = (
    "<Documentation>Renders a volume by directional occlusion shading: quick and without noise, "
    "but biased. The picture has displayed colours (rgba), radiance and depth.</Documentation>"
    + INPUT
    + LOOK
    + number("HalfAngle", "Half Angle", "60", "Of the cone of light, degrees.", least="0",
             most="89.9", whole=False)
    + VIEWING
    + HINTS
)  # fmt: skip

READER = (
    "<Documentation>Reads DICOM, NRRD, NIfTI and MetaImage volumes with their place in the world, "
    "in mm and LPS. Of a DICOM series, choose any file.</Documentation>"
    """
    <StringVectorProperty name="Series" command="SetSeries" number_of_elements="1"
      default_values="">
      <Documentation>Number, UID or description of a DICOM series; empty: the one of most
        slices.</Documentation>
    </StringVectorProperty>"""
    + switch("StandardisedUptake", "Standardised Uptake", "PET by body weight, not as stored.")
    + switch("Resample", "Resample", "Uneven or sheared stacks become a box.")
)

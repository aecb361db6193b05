"""Map images as grey values: PGM read by us (two kinds, any depth), PNG and BMP by Pillow; hostile sizes and truncated files are faults."""

from __future__ import annotations

import io
import re
import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pluto_bt.source import Faults, Place

MAX_PIXELS = 64_000_000  # 400 m square at 0.05 m
MAX_COLOUR_PIXELS = 16_000_000
_PNG_START, _PNG_END = b"\x89PNG\r\n\x1a\n", b"IEND\xaeB`\x82"
_NO_DIGIT = re.compile(rb"[^0-9\s]\S*+|[0-9]{10,}+")
_PGM_HEAD = re.compile(rb"(P[25])(?:\s++|#[^\n]*+\n)++(\d{1,6})(?:\s++|#[^\n]*+\n)++(\d{1,6})(?:\s++|#[^\n]*+\n)++(\d{1,6})(?:\s|#[^\n]*+\n)")


@dataclass(frozen=True, slots=True)
class GreyImage:
    """An image as it is in the file, row 0 at the top.

    Attributes:
        grey: (rows, columns) uint8 or uint16.
        white: the value of full white.
        is_opaque: (rows, columns) bool, or None if every pixel is.
    """

    grey: NDArray[np.uint8] | NDArray[np.uint16]
    white: int
    is_opaque: NDArray[np.bool_] | None = None


def read_grey_image(data: bytes, name: str, place: Place, faults: Faults) -> GreyImage | None:
    """The image in `data`, or None and a fault at `place` (where the map file names the image)."""
    if not data:
        faults.error(place, "bad-image", f'image "{name}" is empty', expected="a PGM or PNG image", found="no bytes")
        return None
    if data[:2] in (b"P2", b"P5"):
        return _read_pgm(data, name, place, faults)
    if data.startswith(_PNG_START) and _PNG_END not in data:  # Pillow does not mind
        faults.error(place, "bad-image", f'image "{name}" is cut off', expected="a PNG image with its end", found=f"{len(data)} bytes without it")
        return None
    return _read_with_pillow(data, name, place, faults)


def _is_too_large(columns: int, rows: int, most: int, name: str, place: Place, faults: Faults) -> bool:
    if columns * rows > most:
        expected = f"at most {most // 1_000_000} million pixels"
        faults.error(place, "too-large", f'image "{name}" is too large', expected=expected, found=f"{columns} x {rows}")
        return True
    if columns * rows == 0:
        faults.error(place, "bad-image", f'image "{name}" has no pixels', expected="at least 1 x 1", found=f"{columns} x {rows}")
        return True
    return False


def _read_pgm(data: bytes, name: str, place: Place, faults: Faults) -> GreyImage | None:
    head = _PGM_HEAD.match(data)
    if head is None:
        expected = "P2 or P5, width, height, white value"
        faults.error(place, "bad-image", f'image "{name}" has no PGM head', expected=expected, found=repr(data[:20])[2:-1])
        return None
    columns, rows, white = (int(number) for number in head.groups()[1:])
    if not 0 < white < 65536:
        faults.error(place, "bad-image", f'image "{name}" has an impossible white value', expected="1 to 65535", found=str(white))
        return None
    if _is_too_large(columns, rows, MAX_PIXELS, name, place, faults):
        return None
    return _pgm_pixels(data, head.end(), head.group(1) == b"P2", columns, rows, white, name, place, faults)


def _pgm_pixels(
    data: bytes, start: int, is_text: bool, columns: int, rows: int, white: int, name: str, place: Place, faults: Faults
) -> GreyImage | None:
    depth = np.dtype(np.uint8) if white < 256 else np.dtype(">u2")
    wanted, unit = (rows * columns, "numbers") if is_text else (rows * columns * depth.itemsize, "bytes")
    values: NDArray[Any]
    if is_text:
        words = re.sub(rb"#[^\n]*", b"", data[start:]) if b"#" in data[start:] else data[start:]
        strange = _NO_DIGIT.search(words)
        if strange is not None:
            what = f'image "{name}" has a pixel that is no whole number'
            faults.error(place, "bad-image", what, expected=f"whole numbers from 0 to {white}", found=repr(strange.group())[2:-1])
            return None
        values = np.fromstring(words.decode("ascii"), dtype=np.int64, sep=" ") if words.strip() else np.zeros(0, np.int64)
        found = values.size
    else:
        found = len(data) - start
        values = np.frombuffer(data, dtype=depth, offset=start, count=min(found // depth.itemsize, rows * columns))
    if found < wanted:
        faults.error(place, "bad-image", f'image "{name}" is cut off', expected=f"{wanted} {unit} for {columns} x {rows} pixels", found=f"{found}")
        return None
    values = values[: rows * columns]
    if values.size and (int(values.max()) > white or int(values.min()) < 0):
        faults.error(place, "bad-image", f'image "{name}" has pixels beyond its white value', expected=f"0 to {white}", found=str(values.max()))
        return None
    pixels = values.reshape(rows, columns)
    return GreyImage(pixels.astype(np.uint8, copy=False) if white < 256 else pixels.astype(np.uint16, copy=False), white)


def _read_with_pillow(data: bytes, name: str, place: Place, faults: Faults) -> GreyImage | None:
    from PIL import Image, UnidentifiedImageError

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # Pillow warns of large images; the limits here are narrower
            image = Image.open(io.BytesIO(data), formats=("PNG", "BMP", "PPM"))
            is_grey = image.mode in ("1", "L", "I;16", "I;16B", "I")
            if _is_too_large(*image.size, MAX_PIXELS if is_grey else MAX_COLOUR_PIXELS, name, place, faults):
                return None
            return _grey(image)
    except Image.DecompressionBombError:
        expected = f"at most {MAX_PIXELS // 1_000_000} million pixels"
        faults.error(place, "too-large", f'image "{name}" is too large', expected=expected, found="far more")
        return None
    except Exception as error:  # a decoder fed with garbage raises OSError, SyntaxError, ValueError, zlib.error, struct.error, …
        what = "no image that can be read" if isinstance(error, UnidentifiedImageError) else f"broken: {error}"
        faults.error(place, "bad-image", f'image "{name}" is {what}', expected="a whole PGM, PNG or BMP image", found=repr(data[:12])[2:-1])
        return None


def _grey(image: Any) -> GreyImage:
    """Colours count by the mean of their channels, as in map_server."""
    if image.mode in ("1", "L"):
        return GreyImage(np.asarray(image if image.mode == "L" else image.convert("L")), 255)
    if image.mode.startswith("I"):
        return GreyImage(np.clip(np.asarray(image), 0, 65535).astype(np.uint16), 65535)
    has_alpha = "A" in image.getbands() or "transparency" in image.info
    pixels = np.asarray(image.convert("RGBA" if has_alpha else "RGB"))
    grey = (pixels[..., :3].sum(axis=2, dtype=np.uint16) // 3).astype(np.uint8)
    return GreyImage(grey, 255, pixels[..., 3] == 255 if has_alpha else None)

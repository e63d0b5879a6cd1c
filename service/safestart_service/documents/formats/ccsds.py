"""A flight as a ZIP of CCSDS messages (OEM, AEM, OPM, OCM in KVN) and a CZML scene. The first file loads NumPy."""

from __future__ import annotations

import io
import zipfile

from safestart_service.documents.formats.base import Format, Record
from safestart_service.documents.formats.czml import courses_in

_FIXED = (1980, 1, 1, 0, 0, 0)


def _encode(record: Record, _: str | None) -> bytes:
    sink = io.BytesIO()
    with zipfile.ZipFile(sink, "w", zipfile.ZIP_DEFLATED) as bundle:
        for name, data in courses_in(record).files().items():
            bundle.writestr(zipfile.ZipInfo(name, _FIXED), data, zipfile.ZIP_DEFLATED)
    return sink.getvalue()


FORMAT = Format("zip", "application/vnd.safestart.ccsds+zip", _encode)

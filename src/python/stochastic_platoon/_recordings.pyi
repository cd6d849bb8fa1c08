from typing import Any, Dict, List, Optional, Tuple

import numpy as np
from numpy.typing import NDArray

from .tables import Columns

class RecordingError(ValueError): ...

class Source:
    def __init__(self, files: List[str], partial: bool, unverified: bool) -> None: ...

def configuration(source: Source) -> str: ...
def values(
    source: Source, streams: List[Tuple[str, int]], first: int, end: int
) -> Tuple[List[NDArray[np.float64]], List[bool]]: ...
def results(
    source: Source, signals: Optional[str]
) -> Tuple[Dict[str, Any], Dict[str, Columns], str, List[str]]: ...

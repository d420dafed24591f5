"""Documents to files and back: found by name, written whole, never overwritten unseen, backed up as one zip."""

from guidance_app.store.backup import Limits, finish_restore, restore, write_backup
from guidance_app.store.documents_folder import Named, Removed, Store, StoreConflictError
from guidance_app.store.files import StoreError, write_file
from guidance_app.store.folders import (
    SAMPLE_OPERATION,
    SAMPLE_RECORDING,
    copy_sample,
    data_folder,
    sample_folder,
    simulated_notice,
)
from guidance_app.store.jobs import field_from_file, load_job
from guidance_app.store.reading import Problem, Stored

__all__ = [
    "SAMPLE_OPERATION",
    "SAMPLE_RECORDING",
    "Limits",
    "Named",
    "Problem",
    "Removed",
    "Store",
    "StoreConflictError",
    "StoreError",
    "Stored",
    "copy_sample",
    "data_folder",
    "field_from_file",
    "finish_restore",
    "load_job",
    "restore",
    "sample_folder",
    "simulated_notice",
    "write_backup",
    "write_file",
]

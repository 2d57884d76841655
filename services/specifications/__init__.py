"""Task specifications on a service: judged, the best by J among the motions found, and kept."""

from predicates.specification.results.record import task_record
from predicates.specification.results.result import StepResult, TaskResult
from services.specifications.find import ready, specification_from, specification_of
from services.specifications.keep import keep
from services.specifications.run import achieve_task
from services.specifications.told import result_json

__all__ = [
    "StepResult",
    "TaskResult",
    "achieve_task",
    "keep",
    "ready",
    "result_json",
    "specification_from",
    "specification_of",
    "task_record",
]

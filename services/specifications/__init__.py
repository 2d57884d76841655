"""Task specifications on a service: judged, and the best by J among the motions found."""

from services.specifications.run import StepResult, TaskResult, achieve_task, ready, specification_of

__all__ = ["StepResult", "TaskResult", "achieve_task", "ready", "specification_of"]

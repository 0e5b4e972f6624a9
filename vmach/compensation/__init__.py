"""Programs moved against the predicted error; knows neither inspection nor the report page."""

from vmach.compensation.compensate import Compensation, compensate

__all__ = ["Compensation", "compensate"]

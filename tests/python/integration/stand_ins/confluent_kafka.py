"""Stands in for confluent_kafka: prints what is produced; a full queue as the real one has."""

from __future__ import annotations

import json


class Producer:
    """Its queue takes one message, until it is polled."""

    def __init__(self, config: dict[str, object]) -> None:
        assert config["bootstrap.servers"], "who is to get it?"
        self._queued = 0

    def produce(self, topic: str, value: bytes, *, key: str, timestamp: int) -> None:
        if self._queued:
            raise BufferError("Local: Queue full")
        self._queued += 1
        print(json.dumps([topic, key, value.hex(), timestamp]), flush=True)

    def poll(self, timeout: float) -> int:
        served, self._queued = self._queued, 0
        return served

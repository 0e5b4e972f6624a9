"""The process that holds the part, when it has died."""

import asyncio
import gc
import io

import pytest

from vmach.workbench.model.remote import ModelStopped, RemoteModel


def buffers():
    return {id(found) for found in gc.get_objects() if type(found) is io.BytesIO}


def test_a_question_to_a_dead_process_leaves_no_buffer_to_the_collector(tmp_path):
    # which cannot close one that is in use: Python 3.13 tells that on standard error
    async def ask():
        model = RemoteModel(tmp_path / "job.toml")
        model._process.kill()
        model._process.join()
        before = buffers()
        with pytest.raises(ModelStopped):
            await model.ask("about")
        left = buffers() - before
        model.close()
        return left

    gc.collect()
    gc.disable()
    try:
        assert not asyncio.run(ask())
    finally:
        gc.enable()

#!/bin/sh
# A process that replaces a worker in tests that answer for it.
exec sleep 60

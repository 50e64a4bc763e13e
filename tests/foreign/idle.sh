#!/bin/sh
# A process in the place of a worker, for tests that answer in its stead.
exec sleep 60

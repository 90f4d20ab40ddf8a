// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pose/graph/chunk_allocator.hpp"

namespace orchard::mapping {

using pose::ChunkAllocator;
using pose::HeapChunkAllocator;

}  // namespace orchard::mapping

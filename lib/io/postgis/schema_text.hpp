// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace orchard::io {

/// orchard_schema.sql, as it stands.
const char* schema_text();

}  // namespace orchard::io

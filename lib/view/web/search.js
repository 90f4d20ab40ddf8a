// Parses "row 3 tree 14", "3/14", "row 3", "id 17", "#17", "17".

function parseQuery(text) {
  const words = text.trim().toLowerCase();
  let match = /^(?:row|r)\s*(\d+)\s*[,;/ ]*\s*(?:tree|place|gap|t|no\.?|number)?\s*(\d+)$/.exec(words) ||
    /^(\d+)\s*[,;/ -]\s*(\d+)$/.exec(words);
  if (match) return { row: Number(match[1]), position: Number(match[2]) };
  match = /^(?:row|r)\s*(\d+)$/.exec(words);
  if (match) return { row: Number(match[1]) };
  match = /^(?:id|#|tree|object)?\s*#?\s*(\d+)$/.exec(words);
  if (match) return { id: Number(match[1]) };
  return null;
}

// Result of a query: {index}, {gap, row}, {wholeRow}, or {words} with the reason why nothing was
// found.
function findInMap(model, text) {
  const query = parseQuery(text);
  if (!query) return { words: "Search for “row 3 tree 14”, “row 3” or “id 17”." };
  if (query.id !== undefined) {
    const index = model.withId(query.id);
    return index >= 0 ? { index } : { words: `No landmark has id ${query.id}.` };
  }
  const row = model.rowOfNumber(query.row);
  if (query.position === undefined) return row ? { wholeRow: row } : { words: `The map has no row ${query.row}.` };
  const index = model.at(query.row, query.position);
  if (index >= 0) return { index };
  if (!row) return { words: `The map has no row ${query.row}.` };
  const gap = row.gaps.find(([position]) => position === query.position);
  if (gap) return { gap, row };
  return { words: `Row ${query.row} has no tree ${query.position}.` };
}

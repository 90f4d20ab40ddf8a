// Parses "row 3 tree 14", "3/14", "row 3", "A-Sur 14", "A-Sur/14", "A-Sur", "id 17", "#17", "17".

// The row and position of words that begin with a row's name; of several names the longest counts.
function parseNamed(model, words) {
  const rows = model.rows.map((row) => [model.rowName(row.number).toLowerCase(), row.number])
    .filter(([name]) => words.startsWith(name)).sort((a, b) => b[0].length - a[0].length);
  for (const [name, row] of rows) {
    const rest = words.slice(name.length);
    if (rest === "") return { row };
    const match = /^(?:\s*[,;/ -]\s*|\s*(?=[a-z]))(?:tree|place|gap|t|no\.?|number)?\s*(\d+)$/.exec(rest);
    if (match) return { row, position: Number(match[1]) };
  }
  return null;
}

function parseQuery(model, text) {
  const words = text.trim().toLowerCase().replace(/\s+/g, " ");
  let match = /^(?:id|#|tree|object)?\s*#?\s*(\d+)$/.exec(words);
  if (match) return { id: Number(match[1]) };
  const named = parseNamed(model, words) || parseNamed(model, words.replace(/^(?:row|r)(?=[\s\d])\s*/, ""));
  if (named) return named;
  match = /^(?:row|r)?\s*(\d+)\s*(?:[,;/ -]\s*|(?=[a-z]))(?:tree|place|gap|t|no\.?|number)?\s*(\d+)$/.exec(words);
  if (match) return { row: Number(match[1]), position: Number(match[2]) };
  match = /^(?:row|r)\s*(\d+)$/.exec(words);
  return match ? { row: Number(match[1]) } : null;
}

// Result of a query: {index}, {gap, row}, {wholeRow}, or {words} with the reason why nothing was
// found.
function findInMap(model, text) {
  const query = parseQuery(model, text);
  if (!query) {
    const name = model.rows.length > 0 ? model.rowName(model.rows[0].number) : "3";
    return { words: `Search for “row ${name} tree 14”, “row ${name}” or “id 17”.` };
  }
  if (query.id !== undefined) {
    const index = model.withId(query.id);
    return index >= 0 ? { index } : { words: `No landmark has id ${query.id}.` };
  }
  const row = model.rowOfNumber(query.row);
  if (!row) return { words: `The map has no row ${query.row}.` };
  if (query.position === undefined) return { wholeRow: row };
  const index = model.at(query.row, query.position);
  if (index >= 0) return { index };
  const gap = row.gaps.find(([position]) => position === query.position);
  if (gap) return { gap, row };
  return { words: `Row ${model.rowName(query.row)} has no tree ${query.position}.` };
}

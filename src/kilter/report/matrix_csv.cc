// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/report/matrix_csv.h"

#include "kilter/report/csv_cell.h"

namespace kilter {

std::string matrix_csv(const Result& result, const std::map<PairId, double>& cells) {
  std::string text;
  for (const SubmapSummary& target : result.submaps) text += ',' + csv_cell(target.name);
  text += '\n';
  auto cell = cells.begin();  // cells come row by row, as they are written
  for (const SubmapSummary& source : result.submaps) {
    text += csv_cell(source.name);
    for (const SubmapSummary& target : result.submaps) {
      text += ',';
      if (cell == cells.end() || cell->first != PairId{source.id, target.id}) continue;
      text += csv_cell(cell->second);
      ++cell;
    }
    text += '\n';
  }
  return text;
}

}  // namespace kilter

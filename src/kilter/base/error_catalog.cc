// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/base/error_catalog.h"

#include <array>

namespace kilter {
namespace {

constexpr std::array kCatalog = {
    CatalogEntry{
        ErrorCode::kUsage, "usage",
        "The command line names an option, command or combination that does not exist. `kilter COMMAND --help` "
        "lists what does. Exit status 2."},
    CatalogEntry{ErrorCode::kConfig, "config",
                 "A configuration key is unknown, its value is of the wrong type or unit, or lies outside its range. "
                 "`kilter config show` lists every key with unit and range. Exit status 2."},
    CatalogEntry{ErrorCode::kNotFound, "not-found",
                 "A file or folder that was named, or that the layout of a mission requires, does not exist. A robot's "
                 "folder holds `poses.*` and either `scans/` or `submaps/`. Exit status 3 for input, 5 for a folder to "
                 "write to."},
    CatalogEntry{
        ErrorCode::kIo, "io",
        "The operating system refused to open, read, write or rename a file; its own reason is in the message. "
        "Check permissions and that the path is a regular file. Exit status 3 for input, 5 for output."},
    CatalogEntry{
        ErrorCode::kParse, "parse",
        "A file's header or text does not follow its format. The message names line or byte, what was expected "
        "and what was found. Exit status 3."},
    CatalogEntry{
        ErrorCode::kTruncated, "truncated",
        "A file ends before the data that its header promises: usually an interrupted copy or a full disk while "
        "recording. Copy it again, or remove the scan and its pose. Exit status 3."},
    CatalogEntry{
        ErrorCode::kCountMismatch, "count-mismatch",
        "There must be exactly one pose per scan, in scan order. Both counts and the first missing one are in "
        "the message. Cuts of `--cuts` must likewise be for all scans, and for robots of the same names; and a "
        "cloud must hold as many points as its header says. Exit status 3."},
    CatalogEntry{ErrorCode::kInvalidPose, "invalid-pose",
                 "A pose holds NaN or Inf, its quaternion is more than 1 % away from unit length, or its matrix is not "
                 "a rotation. Often columns are in another order (kilter reads x y z qx qy qz qw). Exit status 3."},
    CatalogEntry{
        ErrorCode::kInvalidPoints, "invalid-points",
        "A cloud, or each of a robot's scans, has no point that can be used: there is none, or all are NaN, "
        "infinite, farther than any lidar sees (10 km), as georeferenced coordinates are, or outside min_range and "
        "max_range. Exit status 3."},
    CatalogEntry{ErrorCode::kUnsupported, "unsupported",
                 "A file is of a kind or variant that kilter does not read, or a folder holds what does not belong "
                 "together, such as clouds of two formats. Convert the file to .pcd, .ply or .ot, or move away what "
                 "does not belong there; docs/sources.md says what is read. Exit status 3."},
    CatalogEntry{ErrorCode::kEmptyInput, "empty-input",
                 "The source holds no robot, or a robot holds no scan. Exit status 3."},
    CatalogEntry{ErrorCode::kMissingDependency, "missing-dependency",
                 "This build of kilter lacks an optional part; the message names the package to install before "
                 "building. Exit status 3."},
    CatalogEntry{ErrorCode::kInvalidArgument, "invalid-argument",
                 "A value handed to the library lies outside its documented domain. Exit status 2."},
    CatalogEntry{
        ErrorCode::kOutOfMemory, "out-of-memory",
        "The budget of --memory does not hold the two submaps of one pair, what it leaves out cannot be kept in a "
        "temporary file, or the machine's memory is used up. Raise it, use a coarser `resolution`, or limit "
        "`max_range`. Exit status 5."},
    CatalogEntry{
        ErrorCode::kNoSpace, "no-space",
        "The disk that holds the output folder, or the temporary files of a run that --memory bounds, is full. Results "
        "already there were not touched; where standard output is what is full, they are there and whole. Exit status "
        "5."},
    CatalogEntry{ErrorCode::kCancelled, "cancelled",
                 "The run was stopped by a signal; nothing was written. Exit status 129, 130 or 143."},
    CatalogEntry{ErrorCode::kInternal, "internal",
                 "A defect of kilter itself. Please report it with the command line and the version. Exit status 5."},
};

}  // namespace

std::span<const CatalogEntry> error_catalog() { return kCatalog; }

}  // namespace kilter

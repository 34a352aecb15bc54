// SPDX-FileCopyrightText: The kilter authors
// SPDX-License-Identifier: BSD-3-Clause
#include "kilter/io/bags/rosbag2_sqlite.h"

#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <array>
#include <bit>
#include <map>
#include <mutex>
#include <system_error>

#include "kilter/io/file.h"
#include "kilter/io/random_access_file.h"
#include "kilter/io/scalar.h"

namespace kilter {
namespace {

struct CloseDatabase {
  void operator()(sqlite3* database) const { sqlite3_close_v2(database); }
};
struct FinishStatement {
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
struct CloseBlob {
  void operator()(sqlite3_blob* blob) const { sqlite3_blob_close(blob); }
};
using Database = std::unique_ptr<sqlite3, CloseDatabase>;
using Statement = std::unique_ptr<sqlite3_stmt, FinishStatement>;
using Blob = std::unique_ptr<sqlite3_blob, CloseBlob>;

// What a single message may be, and what a row of SQLite cannot do without.
constexpr int kMaxBlobBytes = 1 << 30;
constexpr std::uint64_t kMinRowBytes = 8;

// Pages of a damaged file may lead to one another, so SQLite's steps are counted: some ten are taken for a row.
constexpr int kStepsAtOnce = 1000;
constexpr std::uint64_t kFreeSteps = 10'000'000;
constexpr std::uint64_t kStepsPerByte = 4;

std::string text_of(sqlite3_stmt* statement, int column) {
  const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(statement, column));
  return text == nullptr ? "" : std::string(text, static_cast<std::size_t>(sqlite3_column_bytes(statement, column)));
}

// Names with ? # % would end the path of a URI, or change it.
std::string uri_of(const std::filesystem::path& path) {
  std::string uri = "file:";
  std::error_code error;
  const std::filesystem::path whole = std::filesystem::absolute(path, error);
  for (const char c : whole.native()) {
    const bool is_plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '/' ||
                          c == '.' || c == '_' || c == '-';
    uri += is_plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return uri + "?immutable=1";
}

class Rosbag2Sqlite final : public BagReader {
 public:
  Rosbag2Sqlite(Database database, std::uint64_t file_bytes, std::string where)
      : database_(std::move(database)),
        file_bytes_(file_bytes),
        steps_left_(kFreeSteps + kStepsPerByte * file_bytes),
        where_(std::move(where)) {
    sqlite3_progress_handler(database_.get(), kStepsAtOnce, &Rosbag2Sqlite::count_steps, &steps_left_);
  }

  Expected<void> walk(const MessageVisitor& visit, UnpackingBudget& budget) override;
  Expected<MessageBytes> read(const MessagePlace& place) const override;
  std::string where(const MessagePlace& place) const override {
    return fmt::format("{}: message {}", where_, place.offset);
  }
  void add_note(std::string note) { notes_.push_back(std::move(note)); }

 private:
  // \return whether to stop.
  static int count_steps(void* steps_left) {
    auto& left = *static_cast<std::uint64_t*>(steps_left);
    if (left < kStepsAtOnce) return 1;
    left -= kStepsAtOnce;
    return 0;
  }
  [[nodiscard]] tl::unexpected<Error> refuse(std::string_view doing) const;
  [[nodiscard]] Expected<Statement> prepare(const char* query) const;
  [[nodiscard]] Expected<void> demand_table(const char* name) const;
  [[nodiscard]] Expected<ByteBuffer> read_blob(std::int64_t row, std::uint64_t at_most) const;
  Expected<void> read_topics();
  Expected<void> pass_row(sqlite3_stmt* row, const MessageVisitor& visit);

  Database database_;
  std::uint64_t file_bytes_;
  std::uint64_t steps_left_;  // for the walk
  std::string where_;
  std::map<std::int64_t, std::size_t> topic_of_;  // by id
  mutable std::mutex mutex_;                      // one connection for all threads
};

tl::unexpected<Error> Rosbag2Sqlite::refuse(std::string_view doing) const {
  const int code = sqlite3_errcode(database_.get()) & 0xFF;
  const std::string words =
      fmt::format("{}: SQLite says \"{}\"", doing, printable(sqlite3_errmsg(database_.get()), 200));
  if (code == SQLITE_INTERRUPT) {
    return fail(ErrorCode::kParse, fmt::format("{}: its pages lead to one another without end", doing), where_);
  }
  if (code == SQLITE_NOMEM) return fail(ErrorCode::kOutOfMemory, words, where_);
  if (code == SQLITE_IOERR) return fail(ErrorCode::kIo, words, where_);
  return fail(ErrorCode::kParse, words, where_,
              "for a damaged database: `sqlite3 BROKEN.db3 .recover | sqlite3 MENDED.db3`");
}

Expected<Statement> Rosbag2Sqlite::prepare(const char* query) const {
  sqlite3_stmt* raw = nullptr;
  const int status = sqlite3_prepare_v2(database_.get(), query, -1, &raw, nullptr);
  Statement statement(raw);
  if (status != SQLITE_OK) return refuse("the tables cannot be read");
  return statement;
}

// A view or a virtual table could run anything that the file says.
Expected<void> Rosbag2Sqlite::demand_table(const char* name) const {
  const auto query = prepare("SELECT count(*) FROM sqlite_master WHERE type = 'table' AND name = ?1 AND rootpage > 0");
  if (!query) return pass_up(query.error());
  sqlite3_bind_text(query->get(), 1, name, -1, SQLITE_STATIC);
  if (sqlite3_step(query->get()) != SQLITE_ROW) return refuse("the list of tables cannot be read");
  if (sqlite3_column_int(query->get(), 0) == 1) return {};
  return fail(ErrorCode::kParse,
              fmt::format("expected a rosbag 2 with the tables topics and messages, found no {}", name), where_);
}

Expected<void> Rosbag2Sqlite::read_topics() {
  const auto query = prepare("SELECT id, name, type, serialization_format FROM topics ORDER BY id");
  if (!query) return pass_up(query.error());
  int status = sqlite3_step(query->get());
  for (; status == SQLITE_ROW; status = sqlite3_step(query->get())) {
    BagTopic topic{text_of(query->get(), 1), text_of(query->get(), 2), MessageEncoding::kOther, RosType::kOther, 0};
    const std::string format = text_of(query->get(), 3);
    topic.encoding = format == "cdr" ? MessageEncoding::kCdr : MessageEncoding::kOther;
    if (format != "cdr") topic.type += " as " + format;
    const auto index = find_or_add(std::move(topic), where_);
    if (!index) return pass_up(index.error());
    topic_of_[sqlite3_column_int64(query->get(), 0)] = *index;
    if (topic_of_.size() > kMaxTopics) return fail(ErrorCode::kUnsupported, "too many topics", where_);
  }
  if (status != SQLITE_DONE) return refuse("the topics cannot be read");
  return {};
}

Expected<ByteBuffer> Rosbag2Sqlite::read_blob(std::int64_t row, std::uint64_t at_most) const {
  sqlite3_blob* raw = nullptr;
  const int status = sqlite3_blob_open(database_.get(), "main", "messages", "data", row, 0, &raw);
  const Blob blob(raw);
  if (status != SQLITE_OK) return refuse(fmt::format("message {} cannot be read", row));
  const auto size = static_cast<std::uint64_t>(sqlite3_blob_bytes(blob.get()));
  if (size > file_bytes_)
    return fail(ErrorCode::kParse, fmt::format("message {} is larger than the file", row), where_);
  Expected<ByteBuffer> bytes = ByteBuffer::allocate(static_cast<std::size_t>(std::min(size, at_most)));
  if (!bytes) return bytes;
  if (sqlite3_blob_read(blob.get(), bytes->data(), static_cast<int>(bytes->size()), 0) != SQLITE_OK) {
    return refuse(fmt::format("message {} cannot be read", row));
  }
  return bytes;
}

Expected<void> Rosbag2Sqlite::pass_row(sqlite3_stmt* row, const MessageVisitor& visit) {
  const auto found = topic_of_.find(sqlite3_column_int64(row, 1));
  if (found == topic_of_.end()) return fail(ErrorCode::kParse, "a message of a topic that is not listed", where_);
  BagTopic& topic = topics_[found->second];
  ++topic.messages;
  if (topic.ros_type == RosType::kOther) return {};
  const std::int64_t id = sqlite3_column_int64(row, 0);
  const MessagePlace place{MessagePlace::kNoChunk, static_cast<std::uint64_t>(id), 0};
  Expected<ByteBuffer> bytes = read_blob(id, bytes_wanted(topic.ros_type));
  if (!bytes) return pass_up(bytes.error());
  visit({found->second, sqlite3_column_int64(row, 2), place, bytes->view()});
  return {};
}

Expected<void> Rosbag2Sqlite::walk(const MessageVisitor& visit, UnpackingBudget& /*budget*/) {
  for (const char* table : {"topics", "messages"}) {
    if (auto ok = demand_table(table); !ok) return ok;
  }
  if (auto ok = read_topics(); !ok) return ok;
  const auto query = prepare("SELECT rowid, topic_id, timestamp FROM messages");
  if (!query) return pass_up(query.error());
  std::uint64_t rows = 0;
  int status = sqlite3_step(query->get());
  for (; status == SQLITE_ROW; status = sqlite3_step(query->get())) {
    if (++rows > file_bytes_ / kMinRowBytes) return fail(ErrorCode::kParse, "more rows than fit the file", where_);
    if (auto ok = pass_row(query->get(), visit); !ok) return ok;
  }
  if (status != SQLITE_DONE) return refuse("the messages cannot be read to their end");
  // Reading clouds again takes as long as it is asked for.
  sqlite3_progress_handler(database_.get(), 0, nullptr, nullptr);
  return {};
}

Expected<MessageBytes> Rosbag2Sqlite::read(const MessagePlace& place) const {
  Expected<ByteBuffer> bytes = [&] {
    const std::lock_guard lock(mutex_);
    return read_blob(static_cast<std::int64_t>(place.offset), UINT64_MAX);
  }();
  if (!bytes) return pass_up(bytes.error());
  auto owner = std::make_shared<const ByteBuffer>(*std::move(bytes));
  return MessageBytes{owner, owner->view(), owner->size()};
}

void guard(sqlite3* database) {
  sqlite3_db_config(database, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_db_config(database, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  sqlite3_db_config(database, SQLITE_DBCONFIG_ENABLE_TRIGGER, 0, nullptr);
  sqlite3_db_config(database, SQLITE_DBCONFIG_ENABLE_VIEW, 0, nullptr);
  sqlite3_limit(database, SQLITE_LIMIT_LENGTH, kMaxBlobBytes);
  sqlite3_limit(database, SQLITE_LIMIT_ATTACHED, 0);
}

// SQLite fills up a last page that is cut short by zeros, and a cloud in it with points that nobody saw.
Expected<void> check_pages(const RandomAccessFile& file) {
  std::array<char, 18> head{};
  if (file.size() < head.size()) return {};  // which SQLite calls no database, or an empty one
  if (auto ok = file.read_at(0, head.data(), head.size()); !ok) return ok;
  if (!std::string_view(head.data(), head.size()).starts_with("SQLite format 3")) return {};
  // 65536 does not fit and is written as 1.
  const auto said = load<std::uint16_t>(head.data() + 16, std::endian::big);
  const std::uint64_t page_bytes = said == 1 ? 65536 : said;
  if (page_bytes < 512 || file.size() % page_bytes == 0) return {};
  return fail(
      ErrorCode::kTruncated,
      fmt::format("expected whole pages of {} bytes, found {} of the last one", page_bytes, file.size() % page_bytes),
      at_byte(file.where(), file.size()),
      "the recording was cut short; `sqlite3 BROKEN.db3 .recover | sqlite3 MENDED.db3` may save the rest");
}

}  // namespace

Expected<std::unique_ptr<BagReader>> open_rosbag2_sqlite(const std::filesystem::path& path) {
  // Asked first, for a better answer than SQLite's; it opens folders and pipes too.
  const auto file = RandomAccessFile::open(path);
  if (!file) return pass_up(file.error());
  sqlite3* raw = nullptr;
  const int flags = SQLITE_OPEN_READONLY | SQLITE_OPEN_URI | SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_PRIVATECACHE;
  const int status = sqlite3_open_v2(uri_of(path).c_str(), &raw, flags, nullptr);
  Database database(raw);
  if (status != SQLITE_OK) {
    return fail(ErrorCode::kIo, fmt::format("SQLite cannot open it: {}", sqlite3_errstr(status)), shown(path));
  }
  guard(database.get());
  if (auto whole = check_pages(*file); !whole) return pass_up(whole.error());
  auto reader = std::make_unique<Rosbag2Sqlite>(std::move(database), file->size(), shown(path));
  std::error_code error;
  const std::filesystem::path log = path.native() + "-wal";
  if (const auto bytes = std::filesystem::file_size(log, error); !error && bytes > 0) {
    reader->add_note(
        fmt::format("{} holds messages that were not read; `sqlite3 FILE.db3 'PRAGMA wal_checkpoint'` moves "
                    "them into the bag",
                    shown(log)));
  }
  return reader;
}

}  // namespace kilter

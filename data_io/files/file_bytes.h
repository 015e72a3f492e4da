// Bytes of a whole file, read with a limit on its size, bytes written to a descriptor, and refusals to write.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <system_error>

namespace sonarcal::data_io {

// Throws DataError if the file is absent, unreadable, not a regular file, or longer than `max_bytes` (checked
// before any allocation).
std::string ReadFileBytes(const std::filesystem::path& file, std::size_t max_bytes);

// Returns the text behind the byte order mark of UTF-8, with which some editors begin a file.
std::string_view WithoutByteOrderMark(std::string_view text);

// Writes all bytes to an open file or pipe. Returns 0, or the number of the error (errno). A full disk may
// take a part of them.
int WriteAll(int descriptor, std::span<const std::byte> bytes);

// Error of the last system call that failed (errno), EIO if none has since errno was set to 0. Streams do not
// keep it.
std::error_code LastError();

// Throws DataError: `path` cannot be written.
[[noreturn]] void FailToWrite(const std::filesystem::path& path, const std::error_code& error = LastError());

// Throws DataError if a directory or device has this name, so that no file can replace it.
void RefuseWhatIsNoFile(const std::filesystem::path& path);

}  // namespace sonarcal::data_io

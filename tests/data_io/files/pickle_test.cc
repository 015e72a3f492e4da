#include "data_io/files/pickle.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <limits>
#include <string>
#include <string_view>

#include "core/types/error.h"
#include "tests/data_io/pickle_builder.h"
#include "tests/data_io/refusal.h"

namespace sonarcal::data_io {
namespace {

using Kind = NumpyArray::Kind;
using testing::ArrayValue;
using testing::DictOf;
using testing::DtypeValue;
using ::testing::ElementsAre;
using testing::Global;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using testing::Str;

// pickle.dumps({"PoseSensor": np.array([[1, 2], [3, 4]], "f4"),
//               "ImagingSonar": np.array([[0, 200, 255], [7, 8, 9]], "u1")}, protocol).hex()
// of Python 3.11 and NumPy 1.24.
constexpr std::array<std::string_view, 6> kPickles = {
    // protocol 0
    "286470300a56506f736553656e736f720a70310a636e756d70792e636f72652e6d756c746961727261790a5f7265636f"
    "6e7374727563740a70320a28636e756d70790a6e6461727261790a70330a2849300a7470340a635f636f646563730a65"
    "6e636f64650a70350a2856620a70360a566c6174696e310a70370a7470380a5270390a747031300a527031310a284931"
    "0a2849320a49320a747031320a636e756d70790a64747970650a7031330a285666340a7031340a4930300a4930310a74"
    "7031350a527031360a2849330a563c0a7031370a4e4e4e492d310a492d310a49300a747031380a624930300a67350a28"
    "565c75303030305c7530303030803f5c75303030305c75303030305c7530303030405c75303030305c75303030304040"
    "5c75303030305c753030303080400a7031390a67370a747032300a527032310a747032320a627356496d6167696e6753"
    "6f6e61720a7032330a67320a2867330a2849300a747032340a67390a747032350a527032360a2849310a2849320a4933"
    "0a747032370a6731330a285675310a7032380a4930300a4930310a747032390a527033300a2849330a567c0a7033310a"
    "4e4e4e492d310a492d310a49300a747033320a624930300a67350a28565c7530303030c8ff0708090a7033330a67370a"
    "747033340a527033350a747033360a62732e",
    // protocol 1
    "7d710028580a000000506f736553656e736f727101636e756d70792e636f72652e6d756c746961727261790a5f726563"
    "6f6e7374727563740a710228636e756d70790a6e6461727261790a7103284b00747104635f636f646563730a656e636f"
    "64650a710528580100000062710658060000006c6174696e31710774710852710974710a52710b284b01284b024b0274"
    "710c636e756d70790a64747970650a710d2858020000006634710e4930300a4930310a74710f527110284b0358010000"
    "003c71114e4e4e4affffffff4affffffff4b00747112624930300a68052858120000000000c2803f0000004000004040"
    "0000c280407113680774711452711574711662580c000000496d6167696e67536f6e617271176802286803284b007471"
    "18680974711952711a284b01284b024b0374711b680d2858020000007531711c4930300a4930310a74711d52711e284b"
    "0358010000007c711f4e4e4e4affffffff4affffffff4b00747120624930300a680528580800000000c388c3bf070809"
    "7121680774712252712374712462752e",
    // protocol 2
    "80027d710028580a000000506f736553656e736f727101636e756d70792e636f72652e6d756c746961727261790a5f72"
    "65636f6e7374727563740a7102636e756d70790a6e6461727261790a71034b00857104635f636f646563730a656e636f"
    "64650a7105580100000062710658060000006c6174696e31710786710852710987710a52710b284b014b024b0286710c"
    "636e756d70790a64747970650a710d58020000006634710e898887710f527110284b0358010000003c71114e4e4e4aff"
    "ffffff4affffffff4b007471126289680558120000000000c2803f00000040000040400000c280407113680786711452"
    "711574711662580c000000496d6167696e67536f6e61727117680268034b00857118680987711952711a284b014b024b"
    "0386711b680d58020000007531711c898887711d52711e284b0358010000007c711f4e4e4e4affffffff4affffffff4b"
    "0074712062896805580800000000c388c3bf0708097121680786712252712374712462752e",
    // protocol 3
    "80037d710028580a000000506f736553656e736f727101636e756d70792e636f72652e6d756c746961727261790a5f72"
    "65636f6e7374727563740a7102636e756d70790a6e6461727261790a71034b008571044301627105877106527107284b"
    "014b024b02867108636e756d70790a64747970650a710958020000006634710a898887710b52710c284b035801000000"
    "3c710d4e4e4e4affffffff4affffffff4b0074710e628943100000803f000000400000404000008040710f7471106258"
    "0c000000496d6167696e67536f6e61727111680268034b008571126805877113527114284b014b024b03867115680958"
    "02000000753171168988877117527118284b0358010000007c71194e4e4e4affffffff4affffffff4b0074711a628943"
    "0600c8ff070809711b74711c62752e",
    // protocol 4
    "80049504010000000000007d94288c0a506f736553656e736f72948c156e756d70792e636f72652e6d756c7469617272"
    "6179948c0c5f7265636f6e7374727563749493948c056e756d7079948c076e6461727261799493944b00859443016294"
    "87945294284b014b024b02869468058c0564747970659493948c02663494898887945294284b038c013c944e4e4e4aff"
    "ffffff4affffffff4b007494628943100000803f000000400000404000008040947494628c0c496d6167696e67536f6e"
    "617294680468074b008594680987945294284b014b024b038694680e8c02753194898887945294284b038c017c944e4e"
    "4e4affffffff4affffffff4b0074946289430600c8ff07080994749462752e",
    // protocol 5
    "800595ea000000000000007d94288c0a506f736553656e736f72948c126e756d70792e636f72652e6e756d6572696394"
    "8c0b5f66726f6d627566666572949394289610000000000000000000803f000000400000404000008040948c056e756d"
    "7079948c0564747970659493948c02663494898887945294284b038c013c944e4e4e4affffffff4affffffff4b007494"
    "624b024b0286948c014394749452948c0c496d6167696e67536f6e61729468042896060000000000000000c8ff070809"
    "9468088c02753194898887945294284b038c017c944e4e4e4affffffff4affffffff4b007494624b024b038694680f74"
    "945294752e",
};

std::string BytesOf(std::string_view hex) {
  std::string bytes;
  for (std::size_t i = 0; i < hex.size(); i += 2)
    bytes += static_cast<char>(std::stoi(std::string(hex.substr(i, 2)), nullptr, 16));
  return bytes;
}

NumpyArray ReadOne(const std::string& value) {
  return ReadPickledArrays(DictOf(Str("a") + value), "one.pkl").arrays.at("a");
}

std::string Refusal(const std::string& bytes) {
  std::string message = testing::MessageOf([&] { ReadPickledArrays(bytes, "f.pkl"); });
  EXPECT_THAT(message, StartsWith("f.pkl: byte "));
  EXPECT_EQ(message.find('\n'), std::string::npos);
  return message;
}

TEST(Pickle, EveryProtocolGivesTheSameArrays) {
  for (std::size_t protocol = 0; protocol < kPickles.size(); ++protocol) {
    const PickledDict dict = ReadPickledArrays(BytesOf(kPickles[protocol]), "numpy.pkl");
    EXPECT_THAT(dict.keys, ElementsAre("PoseSensor", "ImagingSonar")) << protocol;
    ASSERT_EQ(dict.arrays.size(), 2u) << protocol;
    const NumpyArray& pose = dict.arrays.at("PoseSensor");
    EXPECT_EQ(pose.TypeName(), "float32");
    EXPECT_THAT(pose.shape, ElementsAre(2, 2));
    EXPECT_EQ(pose.At(0, 0), 1.0);
    EXPECT_EQ(pose.At(0, 1), 2.0);
    EXPECT_EQ(pose.At(1, 0), 3.0);
    EXPECT_EQ(pose.At(1, 1), 4.0);
    const NumpyArray& image = dict.arrays.at("ImagingSonar");
    EXPECT_EQ(image.TypeName(), "uint8");
    EXPECT_EQ(image.ShapeText(), "2 x 3");
    EXPECT_EQ(*image.bytes, BytesOf("00c8ff070809")) << protocol;
    EXPECT_EQ(image.At(0, 1), 200.0);
    EXPECT_EQ(image.At(1, 2), 9.0);
  }
}

TEST(Pickle, ModulesOfNumPy2AreTheSameFunctions) {
  std::string bytes = BytesOf(kPickles[4]);
  const std::string from = "\x15numpy.core.multiarray";
  bytes.replace(bytes.find(from), from.size(), "\x16numpy._core.multiarray");
  bytes[3] = static_cast<char>(bytes[3] + 1);  // length of the frame
  EXPECT_EQ(ReadPickledArrays(bytes, "numpy2.pkl").arrays.size(), 2u);
  bytes = BytesOf(kPickles[5]);
  const std::string buffer = "\x12numpy.core.numeric";
  bytes.replace(bytes.find(buffer), buffer.size(), "\x13numpy._core.numeric");
  bytes[3] = static_cast<char>(bytes[3] + 1);
  EXPECT_EQ(ReadPickledArrays(bytes, "numpy2.pkl").arrays.at("PoseSensor").At(1, 1), 4.0);
}

TEST(Pickle, TypesByteOrdersAndLayoutsGiveTheirValues) {
  const std::string shape = "K\x01K\x02\x86";  // (1, 2)
  const NumpyArray big = ReadOne(ArrayValue(shape, DtypeValue("f4", ">"), BytesOf("3f800000c0200000")));
  EXPECT_EQ(big.At(0, 0), 1.0);
  EXPECT_EQ(big.At(0, 1), -2.5);
  const NumpyArray small = ReadOne(ArrayValue(shape, DtypeValue("i2"), BytesOf("feff0080")));
  EXPECT_EQ(small.TypeName(), "int16");
  EXPECT_EQ(small.At(0, 0), -2.0);
  EXPECT_EQ(small.At(0, 1), -32768.0);
  const NumpyArray wide =
      ReadOne(ArrayValue(shape, DtypeValue("u8"), BytesOf("0000000000000080ffffffffffffffff")));
  EXPECT_EQ(wide.At(0, 0), 9223372036854775808.0);
  EXPECT_EQ(wide.At(0, 1), 18446744073709551616.0);  // rounded
  const NumpyArray real =
      ReadOne(ArrayValue(shape, DtypeValue("f8"), BytesOf("000000000000f03f000000000000f0bf")));
  EXPECT_EQ(real.At(0, 0), 1.0);
  EXPECT_EQ(real.At(0, 1), -1.0);
  const NumpyArray flag = ReadOne(ArrayValue(shape, DtypeValue("b1", "|"), BytesOf("0001")));
  EXPECT_EQ(flag.TypeName(), "bool");
  EXPECT_EQ(flag.At(0, 1), 1.0);
  // np.asfortranarray([[0, 1, 2], [3, 4, 5]]): the bytes run down the columns.
  const NumpyArray fortran =
      ReadOne(ArrayValue("K\x02K\x03\x86", DtypeValue("u1", "|"), BytesOf("000301040205"), true));
  for (int i = 0; i < 6; ++i) EXPECT_EQ(fortran.At(i / 3, i % 3), i);
}

// pickle.dumps({"full": bytearray(b"\x00\xff"), "empty": bytearray(), "none": b""}, protocol).hex()
// of Python 3.11, with protocols 0, 2 and 4.
TEST(Pickle, CallsThatMakeBytesAreExecuted) {
  constexpr std::array<std::string_view, 3> kBytes = {
      "286470300a5666756c6c0a70310a635f5f6275696c74696e5f5f0a6279746561727261790a70320a28635f636f646563"
      "730a656e636f64650a70330a28565c7530303030ff0a70340a566c6174696e310a70350a7470360a5270370a7470380a"
      "5270390a7356656d7074790a7031300a67320a2874527031310a73566e6f6e650a7031320a635f5f6275696c74696e5f"
      "5f0a62797465730a7031330a2874527031340a732e",
      "80027d710028580400000066756c6c7101635f5f6275696c74696e5f5f0a6279746561727261790a7102635f636f6465"
      "63730a656e636f64650a7103580300000000c3bf710458060000006c6174696e31710586710652710785710852710958"
      "05000000656d707479710a68022952710b58040000006e6f6e65710c635f5f6275696c74696e5f5f0a62797465730a71"
      "0d2952710e752e",
      "80049545000000000000007d94288c0466756c6c948c086275696c74696e73948c096279746561727261799493944302"
      "00ff94859452948c05656d7074799468042952948c046e6f6e6594430094752e",
  };
  for (const std::string_view hex : kBytes)
    EXPECT_THAT(ReadPickledArrays(BytesOf(hex), "bytes.pkl").keys, ElementsAre("full", "empty", "none"));
  const auto array_of = [](const std::string& bytes) {
    return Global("numpy.core.numeric", "_frombuffer") + "(" + bytes + DtypeValue("u1", "|") +
           "K\x01K\x02\x86" + Str("C") + "tR";
  };
  const std::string two_bytes = std::string("C\x02") + "\x05\x06";
  for (const char* module : {"builtins", "__builtin__"})
    EXPECT_EQ(*ReadOne(array_of(Global(module, "bytearray") + two_bytes + "\x85R")).bytes, "\x05\x06");
  EXPECT_THAT(Refusal(DictOf(Str("a") + array_of(Global("builtins", "bytearray") + ")R"))),
              HasSubstr("has 0 bytes"));
  // A number of zeros, of which the file holds none.
  EXPECT_THAT(Refusal(DictOf(Str("a") + Global("builtins", "bytearray") + "K\x05\x85R")),
              HasSubstr("expected bytes"));
}

TEST(Pickle, OtherValuesOfTheDictAreNamedAndLeftOut) {
  // {"None": None, "t": 0.5, "n": -3, "l": [1, 2], "b": b"x", 7: True, "d": {}}
  const std::string half = BytesOf("473fe0000000000000");
  const std::string bytes = "\x80\x04}(" + Str("None") + "N" + Str("t") + half + Str("n") + "\x8a\x01\xfd" +
                            Str("l") +
                            "](K\x01K\x02"
                            "e" +
                            Str("b") + "C\x01x" + "K\x07\x88" + Str("d") + "}u.";
  const PickledDict dict = ReadPickledArrays(bytes, "state.pkl");
  EXPECT_TRUE(dict.arrays.empty());
  EXPECT_THAT(dict.keys, ElementsAre("None", "t", "n", "l", "b", "d"));
  // The last of equal keys counts, as in Python.
  const std::string twice =
      "\x80\x04}(" + Str("a") + ArrayValue("K\x01K\x01\x86", DtypeValue("u1"), "\x05") + Str("a") + "Nu.";
  EXPECT_TRUE(ReadPickledArrays(twice, "twice.pkl").arrays.empty());
  EXPECT_THAT(ReadPickledArrays(twice, "twice.pkl").keys, ElementsAre("a"));
}

TEST(Pickle, AnyOtherFunctionIsRefusedByName) {
  const std::string attack = "cos\nsystem\n(S'echo'\ntR.";
  EXPECT_EQ(
      Refusal(attack),
      "f.pkl: byte 0: the pickle calls os.system, which is not executed: expected a dict of NumPy arrays");
  EXPECT_THAT(Refusal(DictOf(Str("a") + Global("builtins", "eval"))), HasSubstr("builtins.eval"));
  EXPECT_THAT(Refusal(DictOf(Str("a") + Global("numpy", "load"))), HasSubstr("numpy.load"));
  EXPECT_THAT(Refusal(DictOf(Str("a") + Global("numpy.core.multiarray", "scalar"))),
              HasSubstr("multiarray.scalar"));
  EXPECT_THAT(Refusal(DictOf(Str("a") + Global("numpy", "ndarray.tofile"))),
              HasSubstr("numpy.ndarray.tofile"));
  EXPECT_THAT(Refusal(DictOf(Str("a") + Global("\x1b[31m", "x"))), HasSubstr("?[31m.x"));
  // Known functions in other roles.
  EXPECT_THAT(Refusal(DictOf(Str("a") + Global("numpy", "ndarray") + ")R")), HasSubstr("numpy.ndarray"));
  EXPECT_THAT(Refusal(DictOf(Str("a") + Global("_codecs", "encode") + Str("x") + Str("rot13") + "\x86R")),
              HasSubstr("latin1"));
  EXPECT_THAT(Refusal(DictOf(Str("a") + Str("f") + ")R")), HasSubstr("expected a function"));
  EXPECT_THAT(Refusal(DictOf(Str("a") + "\x97")), HasSubstr("out-of-band"));
  for (const char* other : {"i", "o", "P1\n", "Q", "\x81", "\x82\x01", "\x92", "\x8f", "S'x'\n"})
    EXPECT_THAT(Refusal(DictOf(Str("a") + other)), HasSubstr("which no pickle of arrays has")) << other;
}

TEST(Pickle, ArraysThatDoNotFitTheirBytesAreRefused) {
  const std::string two_by_three = "K\x02K\x03\x86";
  const std::string u1 = DtypeValue("u1", "|");
  EXPECT_THAT(Refusal(DictOf(Str("a") + ArrayValue(two_by_three, u1, "12345"))),
              HasSubstr("an array of 2 x 3 uint8 has 5 bytes"));
  EXPECT_THAT(Refusal(DictOf(Str("a") + ArrayValue(two_by_three, DtypeValue("f8"), "123456"))),
              HasSubstr("2 x 3 float64 has 6"));
  // 2^62 x 4 bytes are 0 modulo 2^64.
  const std::string huge = BytesOf("8a080000000000000040") + "\x85";
  EXPECT_THAT(Refusal(DictOf(Str("a") + ArrayValue(huge, DtypeValue("f4"), ""))), HasSubstr("has 0 bytes"));
  EXPECT_THAT(Refusal(DictOf(Str("a") + ArrayValue("J\xff\xff\xff\xff\x85", u1, "x"))),
              HasSubstr("length -1"));
  EXPECT_THAT(Refusal(DictOf(Str("a") + ArrayValue(
                                            "(" +
                                                [] {
                                                  std::string s;
                                                  for (int i = 0; i < 33; ++i) s += "K\x01";
                                                  return s;
                                                }() +
                                                "t",
                                            u1, "x"))),
              HasSubstr("33 dimensions"));
  for (const char* type : {"f2", "O8", "c8", "S1", "V4", "i3", "u16", "M8[ns]", "", "f", "f4x"})
    EXPECT_THAT(Refusal(DictOf(Str("a") + DtypeValue(type))), HasSubstr("an array of type")) << type;
  EXPECT_THAT(Refusal(DictOf(Str("a") + DtypeValue("f4", "!"))), HasSubstr("byte order '!'"));
  EXPECT_THAT(Refusal(DictOf(Str("a") + ArrayValue("N", u1, "x"))),
              HasSubstr("expected the shape of an array"));
  EXPECT_THAT(Refusal(DictOf(Str("a") + ArrayValue(two_by_three, "N", "x"))),
              HasSubstr("expected the type of an array"));
}

TEST(Pickle, DataThatEndEarlyAreRefused) {
  for (const std::string_view hex : kPickles) {
    const std::string whole = BytesOf(hex);
    for (std::size_t length = 0; length < whole.size(); ++length)
      EXPECT_NE(Refusal(whole.substr(0, length)), "") << length;
  }
  EXPECT_THAT(Refusal(""), HasSubstr("the data end at byte 0, expected 1 more bytes"));
  EXPECT_THAT(Refusal("."), HasSubstr("a value is missing"));
  EXPECT_THAT(Refusal("N."), HasSubstr("expected a dict of arrays"));
  EXPECT_THAT(Refusal("\x80\x06."), HasSubstr("protocol 6"));
  // Lengths that no file has are refused before anything is allocated.
  EXPECT_THAT(Refusal(BytesOf("80048effffffffffffff7f2e")), HasSubstr("data end at byte 12"));
  EXPECT_THAT(Refusal(BytesOf("80048dffffffffffffffff2e")), HasSubstr("data end at byte 12"));
  EXPECT_THAT(Refusal(BytesOf("800495ffffffffffffffff2e")),
              HasSubstr("a frame of 18446744073709551615 bytes"));
  EXPECT_THAT(Refusal(BytesOf("80048bffffffff2e")), HasSubstr("an integer of"));
}

TEST(Pickle, StackAndMemoAreChecked) {
  EXPECT_THAT(Refusal("0."), HasSubstr("a value is missing"));
  EXPECT_THAT(Refusal("t."), HasSubstr("a mark is missing"));
  EXPECT_THAT(Refusal("N\x86."), HasSubstr("1 values are on the stack, expected 2"));
  EXPECT_THAT(Refusal("N(0."), HasSubstr("a value is missing"));  // it stands below the mark
  EXPECT_THAT(Refusal("h\x05."), HasSubstr("value 5 of the memo"));
  EXPECT_THAT(Refusal("g99999999999999999999\n."), HasSubstr("expected a number"));
  EXPECT_THAT(Refusal("}(NNNu."), HasSubstr("3 keys and values"));
  EXPECT_THAT(Refusal(")Na."), HasSubstr("appended to a tuple"));
  EXPECT_THAT(Refusal("NNb."), HasSubstr("expected a state"));
  EXPECT_THAT(Refusal("N)b."), HasSubstr("expected an array or its type"));
  // A dict and a list that contain themselves.
  EXPECT_TRUE(
      ReadPickledArrays("\x80\x04}\x94(" + Str("a") + std::string("h\0u.", 4), "circle.pkl").arrays.empty());
  EXPECT_TRUE(
      ReadPickledArrays("\x80\x04}" + Str("a") + std::string("]\x94h\0as.", 7), "circle.pkl").arrays.empty());
}

TEST(Pickle, HugeAndDeepPicklesEndQuickly) {
  const auto start = std::chrono::steady_clock::now();
  EXPECT_THAT(Refusal(std::string(2 * kMaxPickleOperations, 'N')), HasSubstr("more than 200000 operations"));
  // Tuples in tuples, as deep as the limit allows.
  const std::string deep = "}N" + std::string(kMaxPickleOperations - 10, '\x85') + "Ns.";
  EXPECT_TRUE(ReadPickledArrays(deep, "deep.pkl").keys.empty());
  // A text of 250 bytes, encoded ever again.
  std::string bomb =
      Str(std::string(250, 'x')) + "\x94" + Global("_codecs", "encode") + "\x94" + Str("latin1") + "\x94";
  for (int i = 0; i < 10'000; ++i) bomb += std::string("h\1h\0h\2\x86R0", 9);
  EXPECT_THAT(Refusal(bomb), HasSubstr("more encoded bytes than the file has"));
  // A text of 100 kB as the key of each of 60,000 items: copies of it would take 6 GB.
  constexpr int kKeyBytes = 100'000;
  std::string keys = "\x80\x04}(X";
  for (const int shift : {0, 8, 16, 24}) keys += static_cast<char>(kKeyBytes >> shift & 0xFF);
  keys += std::string(kKeyBytes, 'k') + "\x94N";
  for (int i = 0; i < 60'000; ++i) keys += std::string("h\0N", 3);
  EXPECT_EQ(ReadPickledArrays(keys + "u.", "keys.pkl").keys.size(), 1U);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(20));
}

TEST(Pickle, DamagedBytesMakeArraysOrADataError) {
  const auto read = [](const std::string& bytes) {
    for (const auto& [key, array] : ReadPickledArrays(bytes, "damaged.pkl").arrays) {
      if (array.shape.size() != 2 || array.shape[0] == 0 || array.shape[1] == 0) continue;
      array.At(array.shape[0] - 1, array.shape[1] - 1);
    }
  };
  for (const std::string_view hex : kPickles) testing::ExpectSurvivesDamage(BytesOf(hex), 600, 3000, read);
}

}  // namespace
}  // namespace sonarcal::data_io

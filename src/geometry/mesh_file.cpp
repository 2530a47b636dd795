#include "impinge/geometry/mesh_file.hpp"

#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <algorithm>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <cctype>
#include <cstdint>

namespace impinge {
namespace {

std::string small_letters(std::string_view text) {
  std::string result(text);
  std::ranges::transform(result, result.begin(),
                         [](char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); });
  return result;
}

/// What is wrong with a PLY file before its points; assimp has no end of some that are wrong.
std::string problem_of_ply(std::string_view content) {
  constexpr std::string_view words[] = {"ply", "format", "comment", "obj_info", "element", "property", "end_header"};
  for (int line = 1; !content.empty(); ++line) {
    const std::size_t end = content.find('\n');
    const std::string_view text = content.substr(0, end), word = text.substr(0, text.find_first_of(" \r"));
    if (std::ranges::find(words, word) == std::ranges::end(words))
      return fmt::format("line {} is none of the header of a PLY file; allowed: {}", line, fmt::join(words, ", "));
    if (word == "end_header") return "";
    content.remove_prefix(end == content.npos ? content.size() : end + 1);
  }
  return "there is no end_header";
}

/// Opens nothing: a surface's file may name others, of materials, which make no walls.
class NoFiles final : public Assimp::IOSystem {
 public:
  bool Exists(const char*) const override { return false; }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char*, const char*) override { return nullptr; }
  void Close(Assimp::IOStream*) override {}
};

}  // namespace

bool is_mesh_file(std::string_view name) {
  const std::string small = small_letters(name);
  return std::ranges::any_of(mesh_endings, [&](std::string_view ending) { return small.ends_with(ending); });
}

std::optional<Facets> read_facets(std::string_view name, std::string_view content, std::vector<std::string>& mistakes) {
  const std::string ending = small_letters(name.substr(name.rfind('.') + 1));
  if (const std::string problem = ending == "ply" ? problem_of_ply(content) : ""; !problem.empty()) {
    mistakes.push_back(fmt::format("cannot be read as a surface: {}", problem));
    return {};
  }
  Assimp::Importer importer;
  importer.SetIOHandler(new NoFiles);  // owned by the importer
  // Points, lines, colours and the like do not make walls; points are joined later.
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  const aiScene* scene = importer.ReadFileFromMemory(
      content.data(), content.size(), aiProcess_Triangulate | aiProcess_SortByPType | aiProcess_PreTransformVertices,
      ending.c_str());
  if (!scene) {
    mistakes.push_back(fmt::format("cannot be read as a surface: {}", importer.GetErrorString()));
    return {};
  }
  Facets result;
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
    const aiMesh& mesh = *scene->mMeshes[m];
    const auto first = static_cast<int>(result.points.size());
    for (unsigned v = 0; v < mesh.mNumVertices; ++v)
      result.points.push_back({{mesh.mVertices[v].x, mesh.mVertices[v].y, mesh.mVertices[v].z}});
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices != 3) continue;
      result.facets.push_back({first + static_cast<int>(face.mIndices[0]), first + static_cast<int>(face.mIndices[1]),
                               first + static_cast<int>(face.mIndices[2])});
    }
  }
  if (result.facets.empty()) {
    mistakes.push_back("has no facets");
    return {};
  }
  return result;
}

std::string digest_of(std::string_view content) {
  std::uint64_t sum = 14695981039346656037U;
  for (const char c : content) sum = (sum ^ static_cast<unsigned char>(c)) * 1099511628211U;
  return fmt::format("{:016x}", sum);
}

}  // namespace impinge

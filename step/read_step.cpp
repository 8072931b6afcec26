// STEP files by Open CASCADE: the only file that includes it. Built with CAMBER_OPENCASCADE.
#include <fstream>
#include <unordered_map>

#include <fmt/format.h>
#include <opencascade/BRepMesh_IncrementalMesh.hxx>
#include <opencascade/BRep_Tool.hxx>
#include <opencascade/IFSelect_ReturnStatus.hxx>
#include <opencascade/Interface_Static.hxx>
#include <opencascade/Message.hxx>
#include <opencascade/Message_Messenger.hxx>
#include <opencascade/Message_PrinterOStream.hxx>
#include <opencascade/Poly_Triangulation.hxx>
#include <opencascade/STEPControl_Reader.hxx>
#include <opencascade/Standard_Failure.hxx>
#include <opencascade/TopExp_Explorer.hxx>
#include <opencascade/TopLoc_Location.hxx>
#include <opencascade/TopoDS.hxx>
#include <opencascade/TopoDS_Face.hxx>
#include <opencascade/TopoDS_Shape.hxx>

#include "base/diagnostics.h"
#include "base/folders.h"
#include "base/triangle_mesh.h"
#include "base/units.h"

namespace camber {
namespace {

struct PointHash {
  std::size_t operator()(const Eigen::Vector3f& p) const {
    std::size_t h = 0;
    for (int a = 0; a < 3; ++a) h = h * 1000003 + std::hash<float>()(p[a]);
    return h;
  }
};

/// Points of neighbouring faces are the same ones of their common edge.
class FaceJoiner {
 public:
  void add(const TopoDS_Face& face) {
    TopLoc_Location location;
    const Handle(Poly_Triangulation) of = BRep_Tool::Triangulation(face, location);
    if (of.IsNull()) return;
    const bool turned = face.Orientation() == TopAbs_REVERSED;
    const gp_Trsf& place = location.Transformation();
    for (int t = 1; t <= of->NbTriangles(); ++t) {
      int corner[3];
      of->Triangle(t).Get(corner[0], corner[1], corner[2]);
      if (turned) std::swap(corner[1], corner[2]);
      std::array<std::uint32_t, 3> out{};
      for (std::size_t c = 0; c < 3; ++c) out[c] = point(of->Node(corner[c]).Transformed(place));
      if (out[0] != out[1] && out[1] != out[2] && out[2] != out[0]) mesh.triangles.push_back(out);
    }
  }
  TriangleMesh mesh;

 private:
  std::uint32_t point(const gp_Pnt& at) {
    // Both faces of an edge have its points up to rounding.
    constexpr double kPerMm = 1e5;
    const auto rounded = [](double v) { return static_cast<float>(std::round(v * kPerMm) / kPerMm + 0.0); };
    const Eigen::Vector3f p(rounded(at.X()), rounded(at.Y()), rounded(at.Z()));
    const auto [it, fresh] = index_.try_emplace(p, static_cast<std::uint32_t>(mesh.points.size()));
    if (fresh) mesh.points.push_back(p);
    return it->second;
  }
  std::unordered_map<Eigen::Vector3f, std::uint32_t, PointHash> index_;
};

/// Open CASCADE writes its statistics to the standard output.
void silence() { Message::DefaultMessenger()->RemovePrinters(STANDARD_TYPE(Message_PrinterOStream)); }

TopoDS_Shape shape_of(const std::string& path) {
  STEPControl_Reader reader;
  Interface_Static::SetCVal("xstep.cascade.unit", "MM");
  if (reader.ReadFile(path.c_str()) != IFSelect_RetDone)
    fail_on_file(path, "cannot be read as STEP (ISO 10303-21); a file of AP203, AP214 or AP242 was expected",
                 "step-format");
  if (reader.TransferRoots() == 0)
    fail_on_file(path, "has no shape that could be transferred; a STEP file with a solid was expected", "step-format");
  return reader.OneShape();
}

}  // namespace

TriangleMesh read_step(const std::string& path) {
  require_confined(path);
  if (!std::ifstream(path)) fail_on_file(path, "cannot be opened; a STEP file was expected", "file-missing");
  silence();
  try {
    const TopoDS_Shape shape = shape_of(path);
    const BRepMesh_IncrementalMesh meshed(shape, kStepChord_mm, false, rad_from_deg(kStepTurn_deg), false);
    FaceJoiner joiner;
    for (TopExp_Explorer at(shape, TopAbs_FACE); at.More(); at.Next()) joiner.add(TopoDS::Face(at.Current()));
    if (joiner.mesh.triangles.empty()) fail_on_file(path, "has no face; a solid was expected", "step-empty");
    return std::move(joiner.mesh);
  } catch (const Standard_Failure& failure) {
    fail_on_file(path, fmt::format("Open CASCADE cannot read it: {}", failure.GetMessageString()), "step-format");
  }
}

}  // namespace camber

// SPDX-License-Identifier: Apache-2.0
// The gyroid over [-1,1]^3 by VTK alone: filled from tables written by hand, contoured by vtkFlyingEdges3D, written as
// binary PLY.
//
//   meso_bench_peer_vtk_flying_edges 800 1 gyroid.ply     samples along each axis, threads, output
//   prints {"triangles": ..., "fillSeconds": ..., "contourSeconds": ..., "writeSeconds": ...} (wall-clock)
//
// One layer of outside samples around the box closes the surface there, as meso sdf closes it.
#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPLYWriter.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkSMPTools.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

namespace {

struct Tables {
  explicit Tables(int n) : sin(static_cast<std::size_t>(n)), cos(static_cast<std::size_t>(n)) {
    for (int i = 0; i < n; ++i) {
      const double phase = 2 * M_PI * (-1 + 2.0 * i / (n - 1));
      sin[static_cast<std::size_t>(i)] = std::sin(phase);
      cos[static_cast<std::size_t>(i)] = std::cos(phase);
    }
  }
  std::vector<double> sin, cos;
};

void fill(vtkImageData& image, int n) {
  const Tables t(n);
  const auto m = static_cast<std::size_t>(n) + 2;
  auto* out = static_cast<float*>(image.GetScalarPointer());
  vtkSMPTools::For(0, n + 2, [&](vtkIdType first, vtkIdType last) {
    for (auto k = static_cast<std::size_t>(first); k < static_cast<std::size_t>(last); ++k) {
      for (std::size_t j = 0; j < m; ++j) {
        float* row = out + (k * m + j) * m;
        if (k == 0 || j == 0 || k == m - 1 || j == m - 1) {
          for (std::size_t i = 0; i < m; ++i) row[i] = 1;
          continue;
        }
        // cos x sin y + cos y sin z + cos z sin x
        const double sin_y = t.sin[j - 1], constant = t.cos[j - 1] * t.sin[k - 1], cos_z = t.cos[k - 1];
        row[0] = row[m - 1] = 1;
        for (std::size_t i = 1; i < m - 1; ++i)
          row[i] = static_cast<float>(t.cos[i - 1] * sin_y + constant + cos_z * t.sin[i - 1]);
      }
    }
  });
}

double seconds_since(std::chrono::steady_clock::time_point& begin) {
  const auto now = std::chrono::steady_clock::now();
  const double seconds = std::chrono::duration<double>(now - begin).count();
  begin = now;
  return seconds;
}

}  // namespace

int main(int argc, char** argv) {
  const int n = argc > 1 ? std::atoi(argv[1]) : 100;
  vtkSMPTools::Initialize(argc > 2 ? std::atoi(argv[2]) : 1);
  auto clock = std::chrono::steady_clock::now();
  const double h = 2.0 / (n - 1);
  vtkNew<vtkImageData> image;
  image->SetDimensions(n + 2, n + 2, n + 2);
  image->SetSpacing(h, h, h);
  image->SetOrigin(-1 - h, -1 - h, -1 - h);
  image->AllocateScalars(VTK_FLOAT, 1);
  fill(*image, n);
  const double fill_seconds = seconds_since(clock);

  vtkNew<vtkFlyingEdges3D> contour;
  contour->SetInputData(image);
  contour->SetValue(0, 0);
  contour->ComputeNormalsOff();
  contour->ComputeGradientsOff();
  contour->ComputeScalarsOff();
  contour->Update();
  const double contour_seconds = seconds_since(clock);

  vtkNew<vtkPLYWriter> writer;
  writer->SetInputData(contour->GetOutput());
  writer->SetFileName(argc > 3 ? argv[3] : "/dev/null");
  writer->SetFileTypeToBinary();
  writer->SetDataByteOrderToLittleEndian();
  const bool written = writer->Write() == 1;
  std::printf("{\"triangles\": %lld, \"fillSeconds\": %.3f, \"contourSeconds\": %.3f, \"writeSeconds\": %.3f}\n",
              static_cast<long long>(contour->GetOutput()->GetNumberOfPolys()), fill_seconds, contour_seconds,
              seconds_since(clock));
  return written ? 0 : 1;
}

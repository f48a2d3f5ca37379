!> The uniform Cartesian grid of gas cells over the whole domain.
module mesh
  use kinds, only: wp
  implicit none
  private
  public :: mesh_t, new_mesh

  !> Cell (i,j,k), each from 1, spans lower + (i-1,j-1,k-1) h to lower + (i,j,k) h.
  type :: mesh_t
    real(wp) :: lower(3)    !< lowest corner of the domain [m]
    real(wp) :: upper(3)    !< highest corner [m]
    integer :: n(3)         !< cells in each direction
    logical :: periodic(3)  !< whether opposite faces are joined
    real(wp) :: h(3)        !< edges of a cell [m]
    real(wp) :: volume      !< volume of a cell [m3]
    real(wp) :: area(3)     !< area of a cell face with the normal x, y, z [m2]
  end type mesh_t

contains

  pure function new_mesh(lower, upper, n, periodic) result(mesh)
    real(wp), intent(in) :: lower(3), upper(3)  !< corners of the domain [m]
    integer, intent(in) :: n(3)                 !< cells in each direction
    logical, intent(in) :: periodic(3)
    type(mesh_t) :: mesh

    mesh%lower = lower
    mesh%upper = upper
    mesh%n = n
    mesh%periodic = periodic
    mesh%h = (upper - lower)/n
    mesh%volume = product(mesh%h)
    mesh%area = mesh%volume/mesh%h
  end function new_mesh

end module mesh

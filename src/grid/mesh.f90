!> The Cartesian grid of gas cells over the whole domain, uniform or graded along each axis.
module mesh
  use grid_axis, only: axis_t, uniform_axis
  use kinds, only: wp
  implicit none
  private
  public :: mesh_t, new_mesh, new_uniform_mesh, unit_step

  !> Cell (i,j,k), each from 1, lies between faces i-1 and i of axis 1, j-1 and j of axis 2, k-1 and k of axis 3.
  type :: mesh_t
    real(wp) :: lower(3)     !< lowest corner of the domain [m]
    real(wp) :: upper(3)     !< highest corner [m]
    integer :: n(3)          !< cells in each direction
    logical :: periodic(3)   !< whether opposite faces are joined
    logical :: uniform       !< whether all cells are equal
    real(wp) :: finest(3)    !< least width of a cell in each direction [m]
    real(wp) :: coarsest(3)  !< and largest [m]
    type(axis_t) :: axis(3)
  contains
    procedure :: in_cells
    procedure :: in_metres
    procedure :: volumes
    procedure :: areas
  end type mesh_t

contains

  pure function new_mesh(axis) result(mesh)
    type(axis_t), intent(in) :: axis(3)
    type(mesh_t) :: mesh

    mesh%axis = axis
    mesh%lower = axis%lower
    mesh%upper = axis%upper
    mesh%n = axis%n
    mesh%periodic = axis%periodic
    mesh%uniform = all(axis%uniform)
    mesh%finest = axis%finest
    mesh%coarsest = axis%coarsest
  end function new_mesh

  pure function new_uniform_mesh(lower, upper, n, periodic) result(mesh)
    real(wp), intent(in) :: lower(3), upper(3)  !< corners of the domain [m]
    integer, intent(in) :: n(3)                 !< cells in each direction
    logical, intent(in) :: periodic(3)
    type(mesh_t) :: mesh

    type(axis_t) :: axis(3)
    integer :: a

    do a = 1, 3
      axis(a) = uniform_axis(lower(a), upper(a), n(a), periodic(a))
    end do
    mesh = new_mesh(axis)
  end function new_uniform_mesh

  !> A place counted in cells: (i,j,k) at the upper corner of cell (i,j,k).
  pure function in_cells(self, x) result(s)
    class(mesh_t), intent(in) :: self
    real(wp), intent(in) :: x(3)  !< [m]
    real(wp) :: s(3)

    integer :: a

    s = [(self%axis(a)%in_cells(x(a)), a=1, 3)]
  end function in_cells

  !> The reverse of in_cells.
  pure function in_metres(self, s) result(x)
    class(mesh_t), intent(in) :: self
    real(wp), intent(in) :: s(3)
    real(wp) :: x(3)

    integer :: a

    x = [(self%axis(a)%in_metres(s(a)), a=1, 3)]
  end function in_metres

  !> Of the cells lo..hi, counted in the whole grid [m3].
  pure function volumes(self, lo, hi) result(volume)
    class(mesh_t), intent(in) :: self
    integer, intent(in) :: lo(3), hi(3)
    real(wp) :: volume(lo(1):hi(1), lo(2):hi(2), lo(3):hi(3))

    integer :: j, k

    do k = lo(3), hi(3)
      do j = lo(2), hi(2)
        volume(:, j, k) = self%axis(1)%width(lo(1):hi(1))*self%axis(2)%width(j)*self%axis(3)%width(k)
      end do
    end do
  end function volumes

  !> Of the faces across direction a of the cells lo..hi, counted in the whole grid [m2].
  pure function areas(self, a, lo, hi) result(area)
    class(mesh_t), intent(in) :: self
    integer, intent(in) :: a, lo(3), hi(3)
    real(wp) :: area(lo(1):hi(1), lo(2):hi(2), lo(3):hi(3))

    integer :: i, j, k, place(3)

    area = self%volumes(lo, hi)
    do k = lo(3), hi(3)
      do j = lo(2), hi(2)
        do i = lo(1), hi(1)
          place = [i, j, k]
          area(i, j, k) = area(i, j, k)/self%axis(a)%width(place(a))
        end do
      end do
    end do
  end function areas

  !> From a cell to the next one across a.
  pure function unit_step(a) result(step)
    integer, intent(in) :: a
    integer :: step(3)

    step = 0
    step(a) = 1
  end function unit_step

end module mesh

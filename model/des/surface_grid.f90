!> Which triangles are near a place: a lattice of cells over a surface, each with the triangles that pass through it.
module surface_grid
  use kinds, only: wp
  implicit none
  private
  public :: surface_grid_t, new_surface_grid

  integer, parameter :: cells_per_triangle = 2, least_cells = 512, most_cells = 2000000
  real(wp), parameter :: wider = 1.0e-6_wp  !< by which cells and surface overlap, over the size of the surface

  type :: surface_grid_t
    real(wp) :: lower(3), width                !< lowest corner, width of a cell [m]
    integer :: n(3)                            !< cells
    integer, allocatable :: first(:)           !< (0:cells) where the triangles of each cell begin
    integer, allocatable :: triangle(:)        !< cell after cell
  contains
    procedure :: range_of
    procedure :: cell_of
  end type surface_grid_t

contains

  pure function new_surface_grid(shape) result(grid)
    real(wp), intent(in) :: shape(:,:,:)  !< (3,4,n) corners [m] and unit normals
    type(surface_grid_t) :: grid

    real(wp) :: extent(3), margin
    integer, allocatable :: next(:)
    integer :: a, wanted, pass, t, cell, x, y, z, lo(3), hi(3)

    grid%lower = [(minval(shape(a, 1:3, :)), a=1, 3)]
    extent = [(maxval(shape(a, 1:3, :)), a=1, 3)] - grid%lower
    margin = wider*norm2(extent)
    grid%lower = grid%lower - margin
    extent = extent + 2*margin
    wanted = min(max(cells_per_triangle*min(size(shape, 3), most_cells), least_cells), most_cells)
    grid%width = width_of(extent, wanted)
    grid%n = int(extent/grid%width) + 1
    allocate (next(0:product(grid%n)), source=0)
    do pass = 1, 2
      do t = 1, size(shape, 3)
        call grid%range_of([(minval(shape(a, 1:3, t)), a=1, 3)] - margin, [(maxval(shape(a, 1:3, t)), a=1, 3)] + margin, lo, hi)
        do z = lo(3), hi(3)
          do y = lo(2), hi(2)
            do x = lo(1), hi(1)
              if (.not. passes(grid, shape(:, :, t), [x, y, z], margin)) cycle
              cell = grid%cell_of(x, y, z)
              if (pass == 2) grid%triangle(next(cell)) = t
              next(cell) = next(cell) + 1
            end do
          end do
        end do
      end do
      if (pass == 2) exit
      allocate (grid%first(0:product(grid%n)))
      grid%first(0) = 1
      do cell = 1, product(grid%n)
        grid%first(cell) = grid%first(cell - 1) + next(cell - 1)
      end do
      allocate (grid%triangle(grid%first(product(grid%n)) - 1))
      next = grid%first
    end do
  end function new_surface_grid

  !> The width of about so many cubes that fill a box, however flat [m].
  pure function width_of(extent, wanted) result(width)
    real(wp), intent(in) :: extent(3)  !< [m]
    integer, intent(in) :: wanted
    real(wp) :: width

    width = maxval(extent)
    do while (product(max(1.0_wp, extent/width)) < wanted)
      width = 0.8_wp*width
    end do
  end function width_of

  !> The cells between two corners, as far as there are any.
  pure subroutine range_of(self, lower, upper, lo, hi)
    class(surface_grid_t), intent(in) :: self
    real(wp), intent(in) :: lower(3), upper(3)  !< [m]
    integer, intent(out) :: lo(3), hi(3)        !< counted from 0; hi < lo where there is none

    real(wp) :: from(3), to(3)

    from = min(max((lower - self%lower)/self%width, -1.0_wp), self%n + 0.5_wp)
    to = min(max((upper - self%lower)/self%width, -1.0_wp), self%n + 0.5_wp)
    lo = max(floor(from), 0)
    hi = min(floor(to), self%n - 1)
  end subroutine range_of

  pure function cell_of(self, x, y, z) result(cell)
    class(surface_grid_t), intent(in) :: self
    integer, intent(in) :: x, y, z  !< counted from 0
    integer :: cell

    cell = x + self%n(1)*(y + self%n(2)*z)
  end function cell_of

  !> Whether the plane of a triangle passes through a cell, or by it within the margin.
  pure function passes(grid, shape, place, margin)
    type(surface_grid_t), intent(in) :: grid
    real(wp), intent(in) :: shape(3, 4)
    integer, intent(in) :: place(3)
    real(wp), intent(in) :: margin  !< [m]
    logical :: passes

    real(wp) :: centre(3)

    centre = grid%lower + (place + 0.5_wp)*grid%width
    passes = abs(dot_product(centre - shape(:, 1), shape(:, 4))) <= 0.5_wp*grid%width*sum(abs(shape(:, 4))) + margin
  end function passes

end module surface_grid

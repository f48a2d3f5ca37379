!> Triangles that share their corners.
!>
!> The corners of a file of triangles are welded where they are one but for round-off. Triangles without an area are left out: two
!> of their corners are one, or all three are on a line; the latter count for whether the surface is closed.
module surface
  use kinds, only: wp
  use sorting, only: ascending
  use wall_motion, only: cross
  implicit none
  private
  public :: surface_t, new_surface

  real(wp), parameter :: sameness = 1.0e-6_wp  !< distance of corners that are one, over the size of the surface
  real(wp), parameter :: oblique(3) = [0.613_wp, 0.531_wp, 0.585_wp]  !< a direction in which few corners are level

  type :: surface_t
    integer :: n = 0                      !< triangles
    real(wp), allocatable :: vertex(:,:)  !< (3,vertices) [m]
    integer, allocatable :: corner(:,:)   !< (3,n) vertices of each triangle
    integer :: degenerate = 0             !< triangles left out
    integer, allocatable :: open_edge(:,:)  !< (2,edges) vertices of those with a triangle on one side only
  end type surface_t

contains

  pure function new_surface(triangles) result(surface)
    real(wp), intent(in) :: triangles(:,:,:)  !< (3,3,n) coordinates of the corners [m]
    type(surface_t) :: surface

    real(wp) :: near
    integer :: a, t

    surface%n = size(triangles, 3)
    near = 0.0_wp
    if (surface%n > 0) near = sameness*norm2([(maxval(triangles(a, :, :)) - minval(triangles(a, :, :)), a=1, 3)])
    call weld(reshape(triangles, [3, 3*surface%n]), near, surface)
    call keep(surface, surface%corner(1, :) /= surface%corner(2, :) .and. surface%corner(2, :) /= surface%corner(3, :) &
              .and. surface%corner(3, :) /= surface%corner(1, :))
    call find_open_edges(surface)
    call keep(surface, [(is_wide(surface, t, near), t=1, surface%n)])
  end function new_surface

  !> Find the corners that are one: along an oblique direction they are close to each other.
  pure subroutine weld(x, near, surface)
    real(wp), intent(in) :: x(:,:)  !< (3,3n) [m]
    real(wp), intent(in) :: near    !< [m]
    type(surface_t), intent(inout) :: surface

    real(wp), allocatable :: height(:)
    integer, allocatable :: order(:), number(:), first(:)
    integer :: m, k, i, n

    allocate (height(size(x, 2)), order(size(x, 2)), number(size(x, 2)), first(size(x, 2)))
    height = matmul(oblique, x)
    order = ascending(height)
    n = 0
    do m = 1, size(order)
      i = order(m)
      number(i) = 0
      do k = n, 1, -1
        if (height(i) - height(first(k)) > 2*near) exit
        if (norm2(x(:, i) - x(:, first(k))) > near) cycle
        number(i) = k
        exit
      end do
      if (number(i) > 0) cycle
      n = n + 1
      first(n) = i
      number(i) = n
    end do
    surface%vertex = x(:, first(:n))
    surface%corner = reshape(number, [3, size(number)/3])
  end subroutine weld

  !> Leave out the triangles that are not to stay.
  pure subroutine keep(surface, stays)
    type(surface_t), intent(inout) :: surface
    logical, intent(in) :: stays(:)  !< (n)

    integer :: t

    surface%degenerate = surface%degenerate + count(.not. stays)
    surface%corner = surface%corner(:, pack([(t, t=1, surface%n)], stays))
    surface%n = size(surface%corner, 2)
  end subroutine keep

  !> Whether a triangle is wide enough to have a normal.
  pure function is_wide(surface, t, near)
    type(surface_t), intent(in) :: surface
    integer, intent(in) :: t
    real(wp), intent(in) :: near  !< [m]
    logical :: is_wide

    real(wp) :: longest

    associate (a => surface%vertex(:, surface%corner(1, t)), b => surface%vertex(:, surface%corner(2, t)), &
               c => surface%vertex(:, surface%corner(3, t)))
      longest = max(norm2(b - a), norm2(c - b), norm2(a - c))
      is_wide = norm2(cross(b - a, c - a)) > near*longest
    end associate
  end function is_wide

  !> An edge that one triangle has and no other is open.
  pure subroutine find_open_edges(surface)
    type(surface_t), intent(inout) :: surface

    real(wp), allocatable :: key(:)
    integer, allocatable :: edge(:,:), order(:)
    logical, allocatable :: alone(:)
    integer :: t, side, m, n

    n = 3*surface%n
    allocate (edge(2, n), key(n), order(n), alone(n))
    do t = 1, surface%n
      do side = 1, 3
        edge(:, 3*(t - 1) + side) = surface%corner([side, modulo(side, 3) + 1], t)
      end do
    end do
    key = minval(edge, 1)*(size(surface%vertex, 2) + 1.0_wp) + maxval(edge, 1)
    order = ascending(key)
    alone = .true.
    do m = 2, n
      if (key(order(m)) - key(order(m - 1)) > 0.5_wp) cycle
      alone(m - 1:m) = .false.
    end do
    surface%open_edge = edge(:, pack(order, alone))
  end subroutine find_open_edges

end module surface

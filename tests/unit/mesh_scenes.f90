!> Surfaces made of triangles, and chambers with them, for the tests of model/des.
module mesh_scenes
  use chamber, only: chamber_t
  use communicator, only: communicator_t
  use constants, only: pi
  use contact_settings, only: contact_settings_t
  use des_scenes, only: random
  use des_settings, only: des_settings_t
  use kinds, only: wp
  use solids, only: solids_t
  use surface, only: surface_t, new_surface
  use wall_motion, only: cross
  use wall_settings, only: wall_settings_t
  implicit none
  private
  public :: mesh_room, mesh, sheet, box, ball, drum, tube, turned

contains

  !> An empty cube from the origin with meshes in it.
  function mesh_room(ranks, edge, gravity, contact, walls, surfaces) result(solids)
    type(communicator_t), intent(in) :: ranks
    real(wp), intent(in) :: edge        !< [m]
    real(wp), intent(in) :: gravity(3)  !< [m/s2]
    type(contact_settings_t), intent(in) :: contact
    type(wall_settings_t), intent(in) :: walls(:)
    type(surface_t), intent(in) :: surfaces(:)
    type(solids_t) :: solids

    type(chamber_t) :: chamber

    chamber%lower = 0.0_wp
    chamber%upper = edge
    chamber%gravity = gravity
    call chamber%add_walls(walls, surfaces)
    call solids%create(ranks, chamber, contact, des_settings_t(), .false., 0.0_wp)
  end function mesh_room

  !> A mesh at rest.
  pure function mesh() result(wall)
    type(wall_settings_t) :: wall

    wall%kind = 'mesh'
    wall%file = 'none.stl'
    wall%rotation_centre = 0.0_wp
  end function mesh

  !> A parallelogram of n(1) by n(2) pieces of two triangles; the corners within it are moved at random by a share of a piece.
  pure function sheet(corner, a, b, n, jitter) result(triangles)
    real(wp), intent(in) :: corner(3), a(3), b(3)  !< [m]
    integer, intent(in) :: n(2)
    real(wp), intent(in) :: jitter                 !< [-]
    real(wp) :: triangles(3, 3, 2*n(1)*n(2))

    real(wp) :: x(3, 0:n(1), 0:n(2)), u, v
    integer :: i, j, t

    do j = 0, n(2)
      do i = 0, n(1)
        u = i
        v = j
        if (i > 0 .and. i < n(1)) u = u + jitter*(random(31*i + 7*j) - 0.5_wp)
        if (j > 0 .and. j < n(2)) v = v + jitter*(random(17*i + 13*j + 5) - 0.5_wp)
        x(:, i, j) = corner + u/n(1)*a + v/n(2)*b
      end do
    end do
    t = 0
    do j = 1, n(2)
      do i = 1, n(1)
        triangles(:, :, t + 1) = reshape([x(:, i - 1, j - 1), x(:, i, j - 1), x(:, i, j)], [3, 3])
        triangles(:, :, t + 2) = reshape([x(:, i - 1, j - 1), x(:, i, j), x(:, i - 1, j)], [3, 3])
        t = t + 2
      end do
    end do
  end function sheet

  !> The six faces of a box, each of n by n pieces.
  pure function box(lower, upper, n) result(triangles)
    real(wp), intent(in) :: lower(3), upper(3)  !< [m]
    integer, intent(in) :: n
    real(wp), allocatable :: triangles(:,:,:)

    real(wp) :: edge(3, 3), extent(3)
    integer :: a, b, c

    extent = upper - lower
    edge = 0.0_wp
    do a = 1, 3
      edge(a, a) = extent(a)
    end do
    allocate (triangles(3, 3, 0))
    do a = 1, 3
      b = modulo(a, 3) + 1
      c = modulo(b, 3) + 1
      triangles = reshape([triangles, sheet(lower, edge(:, b), edge(:, c), [n, n], 0.0_wp), &
                           sheet(upper, -edge(:, b), -edge(:, c), [n, n], 0.0_wp)], [3, 3, size(triangles, 3) + 4*n*n])
    end do
  end function box

  !> A sphere: an octahedron whose faces are parted in n by n, all corners at the radius.
  pure function ball(centre, radius, n) result(triangles)
    real(wp), intent(in) :: centre(3), radius  !< [m]
    integer, intent(in) :: n
    real(wp) :: triangles(3, 3, 8*n*n)

    real(wp) :: a(3), b(3), c(3)
    integer :: octant, i, j, t

    t = 0
    do octant = 0, 7
      a = [merge(1, -1, btest(octant, 0)), 0, 0]
      b = [0, merge(1, -1, btest(octant, 1)), 0]
      c = [0, 0, merge(1, -1, btest(octant, 2))]
      do j = 0, n - 1
        do i = 0, n - 1 - j
          t = t + 1
          triangles(:, :, t) = reshape([place(i, j), place(i + 1, j), place(i, j + 1)], [3, 3])
          if (i + j > n - 2) cycle
          t = t + 1
          triangles(:, :, t) = reshape([place(i + 1, j), place(i + 1, j + 1), place(i, j + 1)], [3, 3])
        end do
      end do
    end do

  contains

    pure function place(k, l) result(x)
      integer, intent(in) :: k, l
      real(wp) :: x(3)

      x = k*a + l*b + (n - k - l)*c
      x = centre + radius*x/norm2(x)
    end function place
  end function ball

  !> The side of a cylinder or cone without lids.
  pure function tube(start, axis, radii, segments) result(triangles)
    real(wp), intent(in) :: start(3), axis(3), radii(2)  !< the axis from end to end, the radii there [m]
    integer, intent(in) :: segments
    real(wp) :: triangles(3, 3, 2*segments)

    real(wp) :: one(3), other(3), rim(3, 0:segments)
    integer :: k

    one = cross(axis, [0.36_wp, 0.48_wp, 0.8_wp])
    one = one/norm2(one)
    other = cross(axis, one)/norm2(axis)
    do k = 0, segments
      rim(:, k) = cos(2*pi*modulo(k, segments)/segments)*one + sin(2*pi*modulo(k, segments)/segments)*other
    end do
    do k = 1, segments
      associate (a => start + radii(1)*rim(:, k - 1), b => start + radii(1)*rim(:, k), &
                 c => start + axis + radii(2)*rim(:, k), d => start + axis + radii(2)*rim(:, k - 1))
        triangles(:, :, 2*k - 1) = reshape([a, b, c], [3, 3])
        triangles(:, :, 2*k) = reshape([a, c, d], [3, 3])
      end associate
    end do
  end function tube

  !> A cylinder with lids; a number of blades of a depth, without thickness, stand inward on its side.
  pure function drum(start, axis, radius, segments, blades, depth) result(triangles)
    real(wp), intent(in) :: start(3), axis(3), radius  !< the axis from lid to lid [m]
    integer, intent(in) :: segments, blades            !< blades divide the segments
    real(wp), intent(in) :: depth                      !< [m]
    real(wp), allocatable :: triangles(:,:,:)

    real(wp) :: one(3), other(3), x(3, 2), inner(3)
    integer :: k, m

    one = cross(axis, [0.36_wp, 0.48_wp, 0.8_wp])
    one = one/norm2(one)
    other = cross(axis, one)/norm2(axis)
    allocate (triangles(3, 3, 0))
    do k = 0, segments - 1
      do m = 0, 1
        x(:, m + 1) = start + radius*(cos(2*pi*modulo(k + m, segments)/segments)*one &
                                      + sin(2*pi*modulo(k + m, segments)/segments)*other)
      end do
      call add(x(:, 1), x(:, 2), x(:, 2) + axis)
      call add(x(:, 1), x(:, 2) + axis, x(:, 1) + axis)
      call add(start, x(:, 2), x(:, 1))
      call add(start + axis, x(:, 1) + axis, x(:, 2) + axis)
      if (blades == 0) cycle
      if (modulo(k, segments/max(blades, 1)) /= 0) cycle
      inner = x(:, 1) + depth/radius*(start - x(:, 1))
      call add(x(:, 1), inner, inner + axis)
      call add(x(:, 1), inner + axis, x(:, 1) + axis)
    end do

  contains

    pure subroutine add(a, b, c)
      real(wp), intent(in) :: a(3), b(3), c(3)

      triangles = reshape([triangles, a, b, c], [3, 3, size(triangles, 3) + 1])
    end subroutine add
  end function drum

  !> The same triangles, turned by a matrix about a point.
  pure function turned(triangles, matrix, centre) result(other)
    real(wp), intent(in) :: triangles(:,:,:), matrix(3, 3), centre(3)
    real(wp) :: other(3, 3, size(triangles, 3))

    integer :: t

    do t = 1, size(triangles, 3)
      other(:, :, t) = matmul(matrix, triangles(:, :, t) - spread(centre, 2, 3)) + spread(centre, 2, 3)
    end do
  end function turned

end module mesh_scenes

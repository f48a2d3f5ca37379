!> The walls that the gas does not pass through, as the distance of a point from them.
module blocking_walls
  use kinds, only: wp
  use level, only: level_t
  use mesh, only: mesh_t
  use mesh_rims, only: body_over, wall_within
  use mesh_wall, only: mesh_wall_t, new_mesh_wall
  use plane, only: plane_t, new_plane
  use shell, only: shell_t, new_shell, find_rim
  use surface, only: surface_t
  use wall_settings, only: wall_settings_t
  implicit none
  private
  public :: blocking_walls_t, new_blocking_walls

  real(wp), parameter :: flush = 1.0e-6_wp  !< of a shell's length: by how much it goes on beyond its ends
  real(wp), parameter :: near_wall = 0.01_wp  !< of a cell: too close to a wall to tell one side from the other

  real(wp), parameter :: aside(3) = [0.613e-7_wp, 0.379e-7_wp, 0.0_wp]  !< over the size of a mesh: where a ray starts

  type, extends(level_t) :: blocking_walls_t
    type(plane_t), allocatable :: planes(:)
    type(shell_t), allocatable :: shells(:)
    integer, allocatable :: shell_side(:)       !< 1: the gas is inside, -1: outside
    logical, allocatable :: goes_on(:,:)        !< (end, shells) whether another shell or the end of the domain is there
    type(mesh_wall_t), allocatable :: meshes(:)  !< as far as they are in the domain
    type(mesh_wall_t), allocatable :: bodies(:)  !< that they bound there
    integer, allocatable :: mesh_side(:)        !< 1: the gas is inside, -1: outside
    real(wp) :: reach = 0.0_wp                  !< beyond which distances from meshes do not matter [m]
  contains
    procedure :: at
    procedure :: moves
    procedure :: velocity
    procedure :: meet_alike
  end type blocking_walls_t

contains

  !> Those of the walls that block.
  pure function new_blocking_walls(walls, surfaces, mesh) result(blocking)
    type(wall_settings_t), intent(in) :: walls(:)
    type(surface_t), intent(in) :: surfaces(:)  !< (walls) of those that are meshes
    type(mesh_t), intent(in) :: mesh            !< of the gas
    type(blocking_walls_t) :: blocking

    integer :: w, side

    allocate (blocking%planes(0), blocking%shells(0), blocking%shell_side(0), blocking%meshes(0), blocking%bodies(0), &
              blocking%mesh_side(0))
    blocking%reach = norm2(mesh%coarsest)
    do w = 1, size(walls)
      if (.not. walls(w)%blocks_gas()) cycle
      side = merge(1, -1, walls(w)%gas_side == 'inside')
      select case (walls(w)%kind)
      case ('plane')
        blocking%planes = [blocking%planes, new_plane(walls(w))]
      case ('mesh')
        blocking%meshes = [blocking%meshes, new_mesh_wall(walls(w), wall_within(surfaces(w), mesh%lower, mesh%upper), 0)]
        blocking%bodies = [blocking%bodies, new_mesh_wall(walls(w), body_over(surfaces(w), mesh%lower, mesh%upper), 0)]
        blocking%mesh_side = [blocking%mesh_side, side]
      case default
        blocking%shells = [blocking%shells, new_shell(walls(w))]
        blocking%shell_side = [blocking%shell_side, side]
      end select
    end do
    call find_ends(blocking, mesh)
  end function new_blocking_walls

  !> Which ends of shells are no ends of what they bound: those that share their rim with another, and those in a face of
  !> the domain.
  pure subroutine find_ends(blocking, mesh)
    type(blocking_walls_t), intent(inout) :: blocking
    type(mesh_t), intent(in) :: mesh

    real(wp) :: centre(3), radius, near
    integer :: s, other, end, a

    allocate (blocking%goes_on(2, size(blocking%shells)), source=.false.)
    near = flush*maxval(mesh%upper - mesh%lower)
    do s = 1, size(blocking%shells)
      if (.not. blocking%shells(s)%has_ends) cycle
      do end = 1, 2
        do other = 1, size(blocking%shells)
          if (other == s .or. blocking%shell_side(other) /= blocking%shell_side(s)) cycle
          blocking%goes_on(end, s) = blocking%goes_on(end, s) .or. blocking%shells(s)%shares_rim(end, blocking%shells(other))
        end do
        call find_rim(blocking%shells(s), end, centre, radius)
        a = maxloc(abs(blocking%shells(s)%axis), dim=1)
        if (abs(blocking%shells(s)%axis(a)) < 1 - flush) cycle
        if (min(abs(centre(a) - mesh%lower(a)), abs(centre(a) - mesh%upper(a))) <= near) blocking%goes_on(end, s) = .true.
      end do
    end do
  end subroutine find_ends

  !> Distance of a point from the nearest of them, negative beyond one [m].
  pure function at(self, x) result(distance)
    class(blocking_walls_t), intent(in) :: self
    real(wp), intent(in) :: x(3)  !< [m]
    real(wp) :: distance

    integer :: m

    distance = huge(1.0_wp)
    do m = 1, size(self%planes)
      distance = min(distance, self%planes(m)%distance(x))
    end do
    do m = 1, size(self%shells)
      distance = min(distance, way_off(self%shells(m), self%shell_side(m), self%goes_on(:, m), x))
    end do
    do m = 1, size(self%meshes)
      distance = min(distance, self%mesh_side(m)*depth_in(self%meshes(m), self%bodies(m), self%reach, x))
    end do
  end function at

  !> See level.
  pure function moves(self)
    class(blocking_walls_t), intent(in) :: self
    logical :: moves

    integer :: m

    moves = .not. all([(self%planes(m)%motion%is_still(), m=1, size(self%planes)), &
                       (self%shells(m)%motion%is_still(), m=1, size(self%shells)), &
                       (self%meshes(m)%motion%is_still(), m=1, size(self%meshes))])
  end function moves

  !> See level. The cap of a shell turns with it.
  pure function velocity(self, x)
    class(blocking_walls_t), intent(in) :: self
    real(wp), intent(in) :: x(3)  !< [m]
    real(wp) :: velocity(3)

    real(wp) :: distance, nearest, way(3), foot(3)
    integer :: m, end

    velocity = 0.0_wp
    nearest = huge(1.0_wp)
    do m = 1, size(self%planes)
      distance = self%planes(m)%distance(x)
      if (distance < nearest) velocity = self%planes(m)%motion%at(x - distance*self%planes(m)%normal)
      nearest = min(nearest, distance)
    end do
    do m = 1, size(self%shells)
      distance = way_off(self%shells(m), self%shell_side(m), self%goes_on(:, m), x)
      if (.not. distance < nearest) cycle
      nearest = distance
      call self%shells(m)%approach(x, way, distance, end)
      velocity = self%shells(m)%motion%at(merge(x - way, x, end == 0))
    end do
    do m = 1, size(self%meshes)
      call find_depth(self%meshes(m), self%bodies(m), self%reach, x, distance, foot)
      if (.not. self%mesh_side(m)*distance < nearest) cycle
      nearest = self%mesh_side(m)*distance
      velocity = self%meshes(m)%motion%at(foot)
    end do
  end function velocity

  !> Whether the gas is on the same parts of the two faces across a, which are joined: at the corners of all cells that are
  !> not close to a wall.
  pure function meet_alike(self, mesh, a) result(alike)
    class(blocking_walls_t), intent(in) :: self
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: a
    logical :: alike

    real(wp) :: x(3), low, high
    integer :: b, c, i, j

    b = modulo(a, 3) + 1
    c = modulo(b, 3) + 1
    alike = .true.
    do j = 0, mesh%n(c)
      x(c) = mesh%axis(c)%face(j)
      do i = 0, mesh%n(b)
        x(b) = mesh%axis(b)%face(i)
        x(a) = mesh%lower(a)
        low = self%at(x)
        x(a) = mesh%upper(a)
        high = self%at(x)
        alike = alike .and. (low*high > 0.0_wp .or. min(abs(low), abs(high)) < near_wall*minval(mesh%finest))
      end do
    end do
  end function meet_alike

  !> Distance from the body that a shell bounds; one with ends reaches from end to end, whether it is the inside that is filled
  !> or the outside. Beyond an end where it goes on it has no say.
  pure function way_off(shell, side, goes_on, x) result(distance)
    type(shell_t), intent(in) :: shell
    integer, intent(in) :: side
    logical, intent(in) :: goes_on(2)
    real(wp), intent(in) :: x(3)  !< [m]
    real(wp) :: distance

    real(wp) :: height, rho, beyond(2)
    integer :: end

    height = dot_product(x - shell%point, shell%axis)
    rho = norm2(x - shell%point - height*shell%axis)
    ! across the generator, which starts at (0, radius)
    distance = side*(height*shell%generator(2) - (rho - shell%radius)*shell%generator(1))
    if (.not. shell%has_ends) return
    beyond = [-height, height - shell%length*shell%generator(1)]
    do end = 1, 2
      if (.not. goes_on(end)) distance = max(distance, beyond(end))
      if (goes_on(end) .and. beyond(end) > flush*shell%length) distance = huge(distance)
    end do
  end function way_off

  !> Distance from a mesh, positive within its body; no larger than the reach.
  pure function depth_in(mesh, body, reach, x) result(depth)
    type(mesh_wall_t), intent(in) :: mesh, body
    real(wp), intent(in) :: reach, x(3)  !< [m]
    real(wp) :: depth

    real(wp) :: foot(3)

    call find_depth(mesh, body, reach, x, depth, foot)
  end function depth_in

  !> The same, and the nearest point of the mesh, or x if none is in reach.
  pure subroutine find_depth(mesh, body, reach, x, depth, foot)
    type(mesh_wall_t), intent(in) :: mesh, body
    real(wp), intent(in) :: reach, x(3)   !< [m]
    real(wp), intent(out) :: depth, foot(3)  !< [m]

    integer :: lo(3), hi(3), i, j, k, cell, t, bearers(2)
    real(wp) :: way(3), distance

    depth = reach
    foot = x
    call mesh%grid%range_of(x - reach, x + reach, lo, hi)
    do k = lo(3), hi(3)
      do j = lo(2), hi(2)
        do i = lo(1), hi(1)
          cell = mesh%grid%cell_of(i, j, k)
          do t = mesh%grid%first(cell), mesh%grid%first(cell + 1) - 1
            if (mesh%is_apart(mesh%grid%triangle(t), x, depth)) cycle
            call mesh%approach(mesh%grid%triangle(t), x, way, distance, bearers)
            if (distance < depth) foot = x - way
            depth = min(depth, distance)
          end do
        end do
      end do
    end do
    if (.not. is_within(body, x)) depth = -depth
  end subroutine find_depth

  !> Whether a point is within a closed mesh: a ray up from it goes through an odd number of triangles. It starts a little beside
  !> the point, as grids are often in line with walls, whose triangles would be seen from their edges.
  pure function is_within(mesh, place) result(within)
    type(mesh_wall_t), intent(in) :: mesh
    real(wp), intent(in) :: place(3)  !< [m]
    logical :: within

    integer :: lo(3), hi(3), k, cell, m
    real(wp) :: x(3), above(3)

    within = .false.
    x = place + aside*mesh%grid%width*maxval(mesh%grid%n)
    above = [x(1), x(2), mesh%grid%lower(3) + mesh%grid%n(3)*mesh%grid%width]
    call mesh%grid%range_of(x, above, lo, hi)
    if (any(hi(1:2) < lo(1:2))) return
    do k = lo(3), hi(3)
      cell = mesh%grid%cell_of(lo(1), lo(2), k)
      do m = mesh%grid%first(cell), mesh%grid%first(cell + 1) - 1
        if (crosses(mesh, mesh%grid%triangle(m), x, mesh%grid%lower(3) + [k, k + 1]*mesh%grid%width)) within = .not. within
      end do
    end do
  end function is_within

  !> Whether a ray up from x goes through a triangle at a height within a range. An edge is looked at the same way round for
  !> both of its triangles, so that a ray through it meets one of them.
  pure function crosses(mesh, t, x, range)
    type(mesh_wall_t), intent(in) :: mesh
    integer, intent(in) :: t
    real(wp), intent(in) :: x(3)      !< [m]
    real(wp), intent(in) :: range(2)  !< [m]
    logical :: crosses

    logical :: left(3)
    integer :: k, next
    real(wp) :: height

    crosses = .false.
    associate (s => mesh%shape(:, :, t), number => mesh%corner(:, t))
      do k = 1, 3
        next = modulo(k, 3) + 1
        if (number(k) < number(next)) then
          left(k) = is_left(s(:, k), s(:, next), x)
        else
          left(k) = .not. is_left(s(:, next), s(:, k), x)
        end if
      end do
      if (.not. (all(left) .or. .not. any(left))) return
      if (.not. abs(s(3, 4)) > 0.0_wp) return
      height = s(3, 1) - (s(1, 4)*(x(1) - s(1, 1)) + s(2, 4)*(x(2) - s(2, 1)))/s(3, 4)
      crosses = height > x(3) .and. height >= range(1) .and. height < range(2)
    end associate
  end function crosses

  !> Whether x is to the left of the way from a to b, as seen from above.
  pure function is_left(a, b, x)
    real(wp), intent(in) :: a(3), b(3), x(3)  !< [m]
    logical :: is_left

    is_left = (b(1) - a(1))*(x(2) - a(2)) - (b(2) - a(2))*(x(1) - a(1)) >= 0.0_wp
  end function is_left

end module blocking_walls

!> A wall of triangles, at rest, moving as a whole, or with a surface that moves along itself.
!>
!> The triangles stay where they were at the start: it is parcels that are looked at from a moving wall. A point x of space at
!> time t is there in c + R^T(t) (x - c - v t), with the centre c, the velocity v and the rotation R of the wall.
!>
!> Parcels may be on either side. Their centres do not come near a wall they bounce off and they move by less than a tenth of
!> their radius in a step; so whose centre is nearer than `closest` radii is about to go through.
module mesh_wall
  use kinds, only: wp
  use surface, only: surface_t
  use surface_grid, only: surface_grid_t, new_surface_grid
  use triangle, only: approach_triangle
  use wall_motion, only: wall_motion_t, cross
  use wall_settings, only: wall_settings_t
  implicit none
  private
  public :: mesh_wall_t, new_mesh_wall, closest

  real(wp), parameter :: closest = 0.25_wp  !< distance of a centre from a mesh, over the radius [-]

  real(wp), parameter :: wider = 1.001_wp   !< a reach, so that round-off leaves nothing out [-]

  type :: mesh_wall_t
    integer :: n = 0                        !< triangles
    integer :: before = 0                   !< triangles of the walls before this one
    real(wp), allocatable :: shape(:,:,:)   !< (3,4,n) corners [m] and unit normal
    real(wp), allocatable :: bound(:,:)     !< (8,n) 1:4 a sphere around it [m], 5:8 unit normal, height of its plane along it [m]
    integer, allocatable :: corner(:,:)     !< (3,n) numbers of the corners: where triangles share one it is the same
    type(surface_grid_t) :: grid
    type(wall_motion_t) :: motion
    integer :: material = 0                 !< see contact_pairs
    logical :: moves = .false.              !< the wall itself
    logical :: slides = .false.             !< its surface, along itself
    real(wp) :: fastest = 0.0_wp            !< speed of the wall where it is highest [m/s]
    real(wp) :: centre(3) = 0.0_wp          !< now [m]
    real(wp) :: turned(3, 3) = 0.0_wp       !< rotation since the start
  contains
    procedure :: move_to
    procedure :: seen
    procedure :: place_of
    procedure :: turned_back
    procedure :: velocity
    procedure :: is_apart
    procedure :: approach
    procedure :: list_near
    procedure :: is_beyond
  end type mesh_wall_t

contains

  pure function new_mesh_wall(settings, surface, before) result(wall)
    type(wall_settings_t), intent(in) :: settings
    type(surface_t), intent(in) :: surface  !< at the start
    integer, intent(in) :: before           !< triangles of the walls before
    type(mesh_wall_t) :: wall

    real(wp) :: normal(3)
    integer :: t, k

    wall%n = surface%n
    wall%before = before
    wall%material = settings%material
    allocate (wall%shape(3, 4, surface%n), wall%bound(8, surface%n), wall%corner(3, surface%n))
    wall%corner(:, :) = surface%corner
    do t = 1, surface%n
      associate (s => wall%shape(:, :, t))
        s(:, 1:3) = surface%vertex(:, surface%corner(:, t))
        normal = cross(s(:, 2) - s(:, 1), s(:, 3) - s(:, 1))
        s(:, 4) = normal/norm2(normal)
        wall%bound(:, t) = [sum(s(:, 1:3), 2)/3, 0.0_wp, s(:, 4), dot_product(s(:, 1), s(:, 4))]
        wall%bound(4, t) = maxval([(norm2(s(:, k) - wall%bound(1:3, t)), k=1, 3)])
      end associate
    end do
    wall%grid = new_surface_grid(wall%shape)
    wall%motion = settings%motion()
    wall%moves = .not. (settings%stays .or. wall%motion%is_still())
    wall%slides = settings%stays .and. .not. wall%motion%is_still()
    if (wall%moves) wall%fastest = norm2(wall%motion%velocity) + &
      maxval([(norm2(cross(wall%motion%spin, surface%vertex(:, k) - wall%motion%centre)), k=1, size(surface%vertex, 2))])
    call wall%move_to(0.0_wp)
  end function new_mesh_wall

  !> Put the wall where it is at a time [s].
  pure subroutine move_to(self, time)
    class(mesh_wall_t), intent(inout) :: self
    real(wp), intent(in) :: time

    self%centre = self%motion%centre + time*self%motion%velocity
    self%turned = self%motion%turn(time)
  end subroutine move_to

  !> Where a point of space is for the wall [m].
  pure function seen(self, x) result(place)
    class(mesh_wall_t), intent(in) :: self
    real(wp), intent(in) :: x(3)  !< [m]
    real(wp) :: place(3)

    place = x
    if (self%moves) place = self%motion%centre + matmul(x - self%centre, self%turned)
  end function seen

  !> Where a point of the wall is in space [m].
  pure function place_of(self, place) result(x)
    class(mesh_wall_t), intent(in) :: self
    real(wp), intent(in) :: place(3)  !< for the wall [m]
    real(wp) :: x(3)

    x = place
    if (self%moves) x = self%centre + matmul(self%turned, place - self%motion%centre)
  end function place_of

  !> A vector as the wall sees it, in space.
  pure function turned_back(self, vector) result(way)
    class(mesh_wall_t), intent(in) :: self
    real(wp), intent(in) :: vector(3)
    real(wp) :: way(3)

    way = vector
    if (self%moves) way = matmul(self%turned, vector)
  end function turned_back

  !> Velocity of the wall in a point of it; of a surface that slides, only what is across the normal [m/s].
  pure function velocity(self, x, normal) result(v)
    class(mesh_wall_t), intent(in) :: self
    real(wp), intent(in) :: x(3)       !< [m]
    real(wp), intent(in) :: normal(3)  !< unit vector
    real(wp) :: v(3)

    v = 0.0_wp
    if (self%moves) v = self%motion%velocity + cross(self%motion%spin, x - self%centre)
    if (self%slides) then
      v = self%motion%at(x)
      v = v - dot_product(v, normal)*normal
    end if
  end function velocity

  !> Whether a triangle is certainly farther than a reach, by the sphere around it and its plane.
  pure function is_apart(self, t, place, reach) result(apart)
    class(mesh_wall_t), intent(in) :: self
    integer, intent(in) :: t
    real(wp), intent(in) :: place(3), reach  !< for the wall [m]
    logical :: apart

    associate (b => self%bound(:, t))
      apart = (place(1) - b(1))**2 + (place(2) - b(2))**2 + (place(3) - b(3))**2 > (reach + b(4))**2 &
              .or. abs(place(1)*b(5) + place(2)*b(6) + place(3)*b(7) - b(8)) > reach
    end associate
  end function is_apart

  !> The way from the nearest point of a triangle to a place, its length, and the numbers of the corners that bear the point:
  !> none within the triangle, two on an edge.
  pure subroutine approach(self, t, place, way, distance, bearers)
    class(mesh_wall_t), intent(in) :: self
    integer, intent(in) :: t
    real(wp), intent(in) :: place(3)   !< for the wall [m]
    real(wp), intent(out) :: way(3)    !< for the wall [m]
    real(wp), intent(out) :: distance  !< [m]
    integer, intent(out) :: bearers(2)

    integer :: k

    call approach_triangle(self%shape(:, :, t), place, way, bearers)
    distance = sqrt(way(1)**2 + way(2)**2 + way(3)**2)
    do k = 1, 2
      if (bearers(k) > 0) bearers(k) = self%corner(bearers(k), t)
    end do
  end subroutine approach

  !> The triangles within a reach, each once.
  pure subroutine list_near(self, sphere, stamp, last, near, n, nearest)
    class(mesh_wall_t), intent(in) :: self
    real(wp), intent(in) :: sphere(4)               !< 1:3 place for the wall, 4 reach [m]
    integer, intent(in) :: stamp                    !< a number not used before
    integer, intent(inout) :: last(:)               !< (triangles) stamp of the last look at each
    integer, allocatable, intent(inout) :: near(:)  !< (n at least)
    integer, intent(out) :: n
    real(wp), intent(inout) :: nearest              !< least distance of all so far [m]

    integer :: lo(3), hi(3), x, y, z, cell, k, t, bearers(2)
    real(wp) :: way(3), distance, wide

    n = 0
    wide = wider*sphere(4)
    call self%grid%range_of(sphere(1:3) - sphere(4), sphere(1:3) + sphere(4), lo, hi)
    do z = lo(3), hi(3)
      do y = lo(2), hi(2)
        do x = lo(1), hi(1)
          cell = self%grid%cell_of(x, y, z)
          do k = self%grid%first(cell), self%grid%first(cell + 1) - 1
            t = self%grid%triangle(k)
            if (last(t) == stamp) cycle
            last(t) = stamp
            if (self%is_apart(t, sphere(1:3), wide)) cycle
            call self%approach(t, sphere(1:3), way, distance, bearers)
            if (distance > sphere(4)) cycle
            nearest = min(nearest, distance)
            if (n == size(near)) near = [near, near]
            n = n + 1
            near(n) = t
          end do
        end do
      end do
    end do
  end subroutine list_near

  !> Whether a parcel's centre is in the wall or about to be.
  pure function is_beyond(self, x, radius)
    class(mesh_wall_t), intent(in) :: self
    real(wp), intent(in) :: x(3), radius  !< [m]
    logical :: is_beyond

    integer :: lo(3), hi(3), i, j, k, cell, m, bearers(2)
    real(wp) :: place(3), way(3), distance

    place = self%seen(x)
    is_beyond = .false.
    call self%grid%range_of(place - closest*radius, place + closest*radius, lo, hi)
    do k = lo(3), hi(3)
      do j = lo(2), hi(2)
        do i = lo(1), hi(1)
          cell = self%grid%cell_of(i, j, k)
          do m = self%grid%first(cell), self%grid%first(cell + 1) - 1
            if (self%is_apart(self%grid%triangle(m), place, wider*closest*radius)) cycle
            call self%approach(self%grid%triangle(m), place, way, distance, bearers)
            is_beyond = is_beyond .or. .not. distance > closest*radius
          end do
        end do
      end do
    end do
  end function is_beyond

end module mesh_wall

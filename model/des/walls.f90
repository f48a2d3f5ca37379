!> Contacts of parcels with the plane faces of the chamber and the walls within it.
!>
!> A wall is a partner of infinite mass and no radius or curvature in the parcel's foot point, the nearest point of the wall,
!> and moves as its surface does there; the law is the one of parcels, with the constants of the parcel's and the wall's materials.
!>
!> A wall of triangles has an entry for every triangle near a parcel. Those of one parcel follow each other, and which of them are
!> contacts is found together.
module walls
  use contact_lanes, only: lanes, full_lanes, lane_of, group_of, record_rows
  use contact_law, only: contact_law_t, friction_forces, frictionless_forces
  use contact_laws, only: contact_laws_t
  use kinds, only: wp
  use mesh_contacts, only: find_contacts, hand_over
  use mesh_wall, only: closest
  use parcels, only: parcels_t
  use wall_entries, only: wall_entries_t, shift_of
  use wall_rolling, only: roll
  use chamber, only: chamber_t, face_normal, n_faces
  implicit none
  private
  public :: wall_list_t

  real(wp), parameter :: never = -1.0_wp  !< the last touch of what has not touched yet
  integer, parameter :: block_pairs = 64  !< contacts given to the law at a time

  !> Parcels that touch a wall or may do so before the list is made again.
  type, extends(wall_entries_t) :: wall_list_t
    integer :: through = 0  !< column of a parcel that is beyond a wall in this step, 0 if there is none
  contains
    procedure :: build
    procedure :: sweep
    procedure :: look_at_run
  end type wall_list_t

contains

  !> List the parcels whose surface is within `margin` of a wall.
  subroutine build(self, chamber, parcels, margin)
    class(wall_list_t), intent(inout) :: self
    type(chamber_t), intent(in) :: chamber
    type(parcels_t), intent(in) :: parcels
    real(wp), intent(in) :: margin  !< [m]

    integer :: i, face, n

    n = 0
    if (.not. allocated(self%parcel)) allocate (self%parcel(64), self%face(64))
    do i = 1, parcels%n
      if (n + n_faces > size(self%parcel)) then
        self%parcel = [self%parcel, self%parcel]
        self%face = [self%face, self%face]
      end if
      associate (s => parcels%state(1:4, i))
        if (all(s(1:3) - chamber%lower > s(4) + margin) .and. all(chamber%upper - s(1:3) > s(4) + margin)) cycle
        do face = 1, n_faces
          if (.not. chamber%is_wall(face)) cycle
          if (chamber%distance(face, s(1:3)) > s(4) + margin) cycle
          n = n + 1
          self%parcel(n) = i
          self%face(n) = face
        end do
      end associate
    end do
    self%kind_end = n
    if (chamber%n_planes + chamber%n_shells > 0) call add_inner(self, chamber, parcels, margin)
    self%kind_end(4) = self%kind_end(3)
    if (chamber%n_meshes > 0) call add_triangles(self, chamber, parcels, margin)
    n = self%kind_end(4)
    self%entries = n
    if (.not. self%with_history) return
    if (allocated(self%slip)) deallocate (self%slip)
    allocate (self%slip(4, n))
    self%slip(1:3, :) = 0.0_wp
    self%slip(4, :) = never
    if (.not. self%with_angles) return
    if (allocated(self%angle)) deallocate (self%angle)
    allocate (self%angle(3, n), source=0.0_wp)
  end subroutine build

  !> The entries of planes and shells.
  subroutine add_inner(self, chamber, parcels, margin)
    type(wall_list_t), intent(inout) :: self
    type(chamber_t), intent(in) :: chamber
    type(parcels_t), intent(in) :: parcels
    real(wp), intent(in) :: margin  !< [m]

    integer :: i, m

    do i = 1, parcels%n
      associate (s => parcels%state(1:4, i))
        do m = 1, chamber%n_planes
          if (chamber%planes(m)%distance(s(1:3)) > s(4) + margin) cycle
          call add_entry(self, 2, i, n_faces + m)
        end do
      end associate
    end do
    self%kind_end(3) = self%kind_end(2)
    do i = 1, parcels%n
      associate (s => parcels%state(1:4, i))
        do m = 1, chamber%n_shells
          if (chamber%shells(m)%distance(s(1:3)) > s(4) + margin) cycle
          call add_entry(self, 3, i, n_faces + chamber%n_planes + m)
        end do
      end associate
    end do
  end subroutine add_inner

  subroutine add_entry(self, kind, i, face)
    type(wall_list_t), intent(inout) :: self
    integer, intent(in) :: kind, i, face

    integer :: n

    n = self%kind_end(kind) + 1
    if (n > size(self%parcel)) then
      self%parcel = [self%parcel, self%parcel]
      self%face = [self%face, self%face]
    end if
    self%parcel(n) = i
    self%face(n) = face
    self%kind_end(kind) = n
  end subroutine add_entry

  !> The entries of triangles. A wall that moves may come as near as the parcel.
  subroutine add_triangles(self, chamber, parcels, margin)
    type(wall_list_t), intent(inout) :: self
    type(chamber_t), intent(in) :: chamber
    type(parcels_t), intent(in) :: parcels
    real(wp), intent(in) :: margin  !< [m]

    integer, allocatable :: stamp(:), near(:), old(:)
    integer :: images(8), n_images, m, i, k, n, e, looks
    real(wp) :: reach, nearest

    allocate (near(64))
    call self%begin_runs(self%kind_end(4))
    if (any(chamber%periodic) .and. .not. allocated(self%image)) allocate (self%image(0))
    associate (last => chamber%meshes(chamber%n_meshes))
      allocate (stamp(last%before + last%n), source=0)
    end associate
    looks = 0
    do i = 1, parcels%n
      do m = 1, chamber%n_meshes
        associate (wall => chamber%meshes(m))
          reach = parcels%state(4, i) + margin*merge(2, 1, wall%moves)
          call chamber%find_images(parcels%state(1:3, i), reach, images, n_images)
          nearest = reach
          do k = 1, n_images
            looks = looks + 1
            call wall%list_near([wall%seen(parcels%state(1:3, i) + chamber%shift(images(k))), reach], looks, &
                                stamp(wall%before + 1:wall%before + wall%n), near, n, nearest)
            do e = 1, n
              call add_entry(self, 4, i, chamber%first_triangle() - 1 + wall%before + near(e))
              if (.not. any(chamber%periodic)) cycle
              if (self%kind_end(4) > size(self%image)) then
                allocate (old(size(self%parcel)), source=0)
                old(:size(self%image)) = self%image
                call move_alloc(old, self%image)
              end if
              self%image(self%kind_end(4)) = images(k)
            end do
          end do
          call self%end_run(self%kind_end(4), nearest - parcels%state(4, i))
        end associate
      end do
    end do
  end subroutine add_triangles

  !> Add the forces and torques of all walls on the parcels taken.
  pure subroutine sweep(self, chamber, laws, parcels)
    class(wall_list_t), intent(inout) :: self
    type(chamber_t), intent(in) :: chamber
    type(contact_laws_t), intent(in) :: laws
    type(parcels_t), intent(inout) :: parcels

    call sweep_faces(self, chamber, laws, parcels)
    if (chamber%n_planes > 0) call sweep_planes(self, chamber, laws, parcels)
    if (chamber%n_shells > 0) call sweep_shells(self, chamber, laws, parcels)
    if (chamber%n_meshes > 0) call sweep_meshes(self, chamber, laws, parcels)
  end subroutine sweep

  pure subroutine sweep_faces(self, chamber, laws, parcels)
    type(wall_list_t), intent(inout) :: self
    type(chamber_t), intent(in) :: chamber
    type(contact_laws_t), intent(in) :: laws
    type(parcels_t), intent(inout) :: parcels

    real(wp) :: pair(8, block_pairs), d
    integer :: touching(block_pairs), n, w

    n = 0
    do w = self%first(1), self%last(1)
      associate (s => parcels%state(1:8, self%parcel(w)), face => self%face(w))
        d = chamber%distance(face, s(1:3))
        if (.not. d > 0.0_wp) then
          self%through = self%parcel(w)
        else if (d < s(4)) then
          n = n + 1
          touching(n) = w
          pair(1:3, n) = d*face_normal(face)
          pair(4:8, n) = s(4:8)
        end if
      end associate
      if (n == block_pairs) then
        call apply(self, chamber, laws, touching(1:n), pair, parcels)
        n = 0
      end if
    end do
    if (n > 0) call apply(self, chamber, laws, touching(1:n), pair, parcels)
  end subroutine sweep_faces

  pure subroutine sweep_planes(self, chamber, laws, parcels)
    type(wall_list_t), intent(inout) :: self
    type(chamber_t), intent(in) :: chamber
    type(contact_laws_t), intent(in) :: laws
    type(parcels_t), intent(inout) :: parcels

    real(wp) :: pair(8, block_pairs), d
    integer :: touching(block_pairs), n, w

    n = 0
    do w = self%first(2), self%last(2)
      associate (s => parcels%state(1:8, self%parcel(w)), plane => chamber%planes(self%face(w) - n_faces))
        d = plane%distance(s(1:3))
        if (.not. d > 0.0_wp) then
          self%through = self%parcel(w)
        else if (d < s(4)) then
          n = n + 1
          touching(n) = w
          pair(1:3, n) = d*plane%normal
          pair(4:8, n) = s(4:8)
          pair(5:7, n) = s(5:7) - plane%motion%at(s(1:3) - pair(1:3, n))
        end if
      end associate
      if (n == block_pairs) then
        call apply(self, chamber, laws, touching(1:n), pair, parcels)
        n = 0
      end if
    end do
    if (n > 0) call apply(self, chamber, laws, touching(1:n), pair, parcels)
  end subroutine sweep_planes

  pure subroutine sweep_shells(self, chamber, laws, parcels)
    type(wall_list_t), intent(inout) :: self
    type(chamber_t), intent(in) :: chamber
    type(contact_laws_t), intent(in) :: laws
    type(parcels_t), intent(inout) :: parcels

    real(wp) :: pair(8, block_pairs), way(3), d
    integer :: touching(block_pairs), n, w, m

    n = 0
    do w = self%first(3), self%last(3)
      m = self%face(w) - n_faces - chamber%n_planes
      associate (s => parcels%state(1:8, self%parcel(w)), shell => chamber%shells(m))
        call chamber%approach_shell(m, s(1:3), way, d)
        if (shell%is_beyond(d, s(4))) then
          self%through = self%parcel(w)
        else if (d < s(4)) then
          n = n + 1
          touching(n) = w
          pair(1:3, n) = way
          pair(4:8, n) = s(4:8)
          pair(5:7, n) = s(5:7) - shell%motion%at(s(1:3) - way)
        end if
      end associate
      if (n == block_pairs) then
        call apply(self, chamber, laws, touching(1:n), pair, parcels)
        n = 0
      end if
    end do
    if (n > 0) call apply(self, chamber, laws, touching(1:n), pair, parcels)
  end subroutine sweep_shells

  pure subroutine sweep_meshes(self, chamber, laws, parcels)
    type(wall_list_t), intent(inout) :: self
    type(chamber_t), intent(in) :: chamber
    type(contact_laws_t), intent(in) :: laws
    type(parcels_t), intent(inout) :: parcels

    real(wp) :: pair(8, block_pairs)
    integer :: touching(block_pairs), n, run

    n = 0
    do run = self%first(4), self%last(4)
      if (self%run_gap(run) > self%way) cycle
      call sweep_run(self, chamber, laws, parcels, self%run_range(run), touching, n, pair)
    end do
    if (n > 0) call apply(self, chamber, laws, touching(1:n), pair, parcels)
  end subroutine sweep_meshes

  !> The contacts of one parcel with one mesh.
  pure subroutine sweep_run(self, chamber, laws, parcels, range, touching, n, pair)
    type(wall_list_t), intent(inout) :: self
    type(chamber_t), intent(in) :: chamber
    type(contact_laws_t), intent(in) :: laws
    type(parcels_t), intent(inout) :: parcels
    integer, intent(in) :: range(2)                    !< entries
    integer, intent(inout) :: touching(:), n           !< contacts that wait for the law
    real(wp), intent(inout) :: pair(8, block_pairs)

    real(wp) :: gap(4, range(2) - range(1) + 1), normal(3)
    integer :: chosen(size(gap, 2)), contacts, c, m

    call self%look_at_run(chamber, parcels, range, gap, chosen, contacts)
    if (contacts == 0) return
    if (.not. gap(4, chosen(1)) > closest*parcels%state(4, self%parcel(range(1)))) then
      self%through = self%parcel(range(1))
      return
    end if
    if (self%with_angles) then
      call hand_over(self%step, gap, chosen(:contacts), self%slip(:, range(1):range(2)), self%angle(:, range(1):range(2)))
    else if (self%with_history) then
      call hand_over(self%step, gap, chosen(:contacts), self%slip(:, range(1):range(2)))
    end if
    m = chamber%mesh_of(self%face(range(1)))
    do c = 1, contacts
      n = n + 1
      touching(n) = range(1) - 1 + chosen(c)
      associate (s => parcels%state(1:8, self%parcel(range(1))), wall => chamber%meshes(m))
        pair(1:3, n) = wall%turned_back(gap(1:3, chosen(c)))
        pair(4:8, n) = s(4:8)
        normal = pair(1:3, n)/gap(4, chosen(c))
        pair(5:7, n) = s(5:7) - wall%velocity(s(1:3) + shift_of(self, chamber, touching(n)) - pair(1:3, n), normal)
      end associate
      if (n == block_pairs) then
        call apply(self, chamber, laws, touching(1:n), pair, parcels)
        n = 0
      end if
    end do
  end subroutine sweep_run

  !> Where a parcel touches a mesh.
  pure subroutine look_at_run(self, chamber, parcels, range, gap, chosen, n, reach)
    class(wall_list_t), intent(in) :: self
    type(chamber_t), intent(in) :: chamber
    type(parcels_t), intent(in) :: parcels
    integer, intent(in) :: range(2)                      !< entries
    real(wp), intent(out) :: gap(:,:)                    !< see find_contacts
    integer, intent(out) :: chosen(:), n
    real(wp), intent(in), optional :: reach              !< for what is so far from its surface, too [m]

    real(wp) :: place(3, range(2) - range(1) + 1), radius
    integer :: k

    associate (s => parcels%state(1:4, self%parcel(range(1))), face => self%face(range(1):range(2)), &
               wall => chamber%meshes(chamber%mesh_of(self%face(range(1)))))
      place(:, 1) = wall%seen(s(1:3) + shift_of(self, chamber, range(1)))
      do k = 2, size(place, 2)
        place(:, k) = place(:, 1)
        if (any(chamber%periodic)) place(:, k) = wall%seen(s(1:3) + shift_of(self, chamber, range(1) - 1 + k))
      end do
      radius = s(4)
      if (present(reach)) radius = radius + reach
      call find_contacts(wall, face - (chamber%first_triangle() - 1 + wall%before), place, radius, gap, chosen, n)
    end associate
  end subroutine look_at_run

  !> Forces of a block of contacts with walls: those of each law together.
  pure subroutine apply(self, chamber, laws, touching, pair, parcels)
    class(wall_list_t), intent(inout) :: self
    type(chamber_t), intent(in) :: chamber
    type(contact_laws_t), intent(in) :: laws
    integer, intent(in) :: touching(:)                 !< (n) entries
    real(wp), intent(inout) :: pair(8, block_pairs)    !< see contact_linear
    type(parcels_t), intent(inout) :: parcels

    real(wp) :: chosen_pair(8, block_pairs)
    integer :: chosen(block_pairs), law, m, n

    if (size(laws%wall) == 1) call apply_law(self, chamber, laws%wall(1), touching, pair, parcels)
    do law = 1, merge(size(laws%wall), 0, size(laws%wall) > 1)
      n = 0
      do m = 1, size(touching)
        associate (w => touching(m))
          if (laws%of_wall(parcels%powder(self%parcel(w)), chamber%material_of(self%face(w))) /= law) cycle
        end associate
        n = n + 1
        chosen(n) = touching(m)
        chosen_pair(:, n) = pair(:, m)
      end do
      if (n > 0) call apply_law(self, chamber, laws%wall(law), chosen(1:n), chosen_pair, parcels)
    end do
  end subroutine apply

  !> Forces of contacts of one law. Lanes left over repeat the last contact.
  pure subroutine apply_law(self, chamber, law, touching, pair, parcels)
    class(wall_list_t), intent(inout) :: self
    type(chamber_t), intent(in) :: chamber
    type(contact_law_t), intent(in) :: law
    integer, intent(in) :: touching(:)                 !< (n) entries
    real(wp), intent(inout) :: pair(8, block_pairs)    !< see contact_linear
    type(parcels_t), intent(inout) :: parcels

    real(wp) :: spin(4, block_pairs), record(lanes, record_rows, block_pairs/lanes), force(8, block_pairs)
    real(wp) :: push(4, block_pairs), curvature(block_pairs)
    integer :: n, m, at, full

    n = size(touching)
    full = full_lanes(n)
    do m = n + 1, full
      pair(:, m) = pair(:, n)
    end do
    if (.not. self%with_history) then
      curvature(1:full) = 1/pair(4, 1:full)
      call frictionless_forces(law, full, pair, curvature, push)
      do m = 1, n
        at = parcels%force_at(self%parcel(touching(m)))
        parcels%force(at:at + 2) = parcels%force(at:at + 2) + push(1:3, m)
      end do
      return
    end if
    do m = 1, full
      associate (w => touching(min(m, n)), l => lane_of(m), g => group_of(m))
        spin(:, m) = parcels%state(9:12, self%parcel(w))
        record(l, 1:3, g) = merge(self%slip(1:3, w), 0.0_wp, self%slip(4, w) >= self%step - 1.5_wp)
        record(l, 4, g) = 1/sqrt(pair(8, m))
        record(l, 5, g) = 1/pair(4, m)
      end associate
    end do
    call friction_forces(law, full, pair, spin, record, force)
    if (law%rolling%on) call roll(self%wall_entries_t, chamber, law, touching, pair, force, parcels)
    do m = 1, n
      self%slip(1:3, touching(m)) = record(lane_of(m), 1:3, group_of(m))
      self%slip(4, touching(m)) = self%step
      at = parcels%force_at(self%parcel(touching(m)))
      parcels%force(at:at + 7) = parcels%force(at:at + 7) + force(:, m)
    end do
  end subroutine apply_law

end module walls

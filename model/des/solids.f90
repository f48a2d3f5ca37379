!> All parcels of the run and everything they do without gas: contacts, walls, motion, neighbour lists, and the
!> exchange between ranks.
!>
!> A solids step: contact forces, kick, drift, of one stretch of parcels after the other; then either a refresh of the ghosts
!> or, once a parcel may have moved half the skin since the lists were made, new lists. Making them moves parcels to the ranks
!> that own their places, sorts them in space and gives the contacts their slips back.
module solids
  use close_pairs, only: close_pairs_t
  use cohesion_sweep, only: attract_walls
  use communicator, only: communicator_t
  use contact_history, only: history_t
  use contact_laws, only: contact_laws_t, new_contact_laws
  use contact_list, only: contact_list_t, stretch_rows
  use contact_parts, only: part_t, deal, gathered, are_due, begin_pairs, second_of_pairs, any_tight, widest_window, sweep_rows, &
    attract_rows
  use contact_settings, only: contact_settings_t
  use constants, only: pi, is_set
  use des_settings, only: des_settings_t
  use ghosts, only: ghosts_t
  use kinds, only: wp, i8
  use load_balance, only: rebalance, lists_per_look
  use list_skin, only: widest_skin, fitting_skin, skin_within
  use migration, only: settle_owners
  use motion, only: start_lead, add_lead, take_lead, drift, kick_and_drift, note_places, farthest, fastest_speed
  use neighbours, only: search_t
  use outcome, only: outcome_t
  use parcel_extremes, only: widen_extremes
  use parcels, only: parcels_t
  use read_ahead, only: read_ahead_t
  use solids_trouble, only: find_trouble, check_period
  use tiles, only: tiles_t, new_tiles
  use chamber, only: chamber_t
  use walls, only: wall_list_t
  implicit none
  private
  public :: solids_t

  real(wp), parameter :: farthest_step = 0.1_wp      !< way of a parcel in one step, over the smallest radius

  type :: solids_t
    type(communicator_t) :: comm
    type(chamber_t) :: chamber
    type(contact_settings_t) :: contact
    type(des_settings_t) :: numerics
    type(contact_laws_t) :: laws
    type(parcels_t) :: parcels
    type(tiles_t) :: tiles               !< exist once parcels do
    integer :: tilings = 0               !< how often tiles were made or changed hands
    type(contact_list_t) :: list
    type(close_pairs_t) :: pairs         !< pairs of the list
    type(part_t), allocatable :: parts(:)  !< with several laws: list and pairs dealt by them, which take the place of `pairs`
    type(read_ahead_t) :: ahead          !< for the list
    type(wall_list_t) :: walls
    type(ghosts_t) :: ghosts
    type(history_t) :: history           !< slips between two lists
    type(search_t) :: search
    real(wp) :: tile_width = 0.0_wp      !< least width asked for [m]
    real(wp) :: skin = 0.0_wp            !< [m]
    logical :: attract = .false.         !< whether listed pairs act that are not close
    real(wp) :: reach = 0.0_wp           !< of the attraction, from surface to surface [m]
    real(wp) :: range = 0.0_wp           !< largest distance of the centres of a listed pair [m]
    real(wp) :: smallest_radius = huge(1.0_wp), largest_radius = 0.0_wp  !< on all ranks [m]
    real(wp), allocatable :: lightest(:), smallest(:)  !< (0:M) mass [kg] and radius [m] of a parcel of each material, on all ranks
    real(wp) :: largest_ratio = 0.0_wp   !< of radius over mass of a parcel, on all ranks [m/kg]
    real(wp) :: time = 0.0_wp            !< [s]
    real(wp) :: step = 0.0_wp            !< steps done; a real, as walls keep it
    real(wp) :: travelled = 0.0_wp       !< at most, by any parcel since the lists were made [m]
    real(wp) :: speed = 0.0_wp           !< of the fastest parcel [m/s]
    real(wp) :: listed_at = 0.0_wp       !< time for which walls stood where they did when the lists were made [s]
    integer(i8) :: rebuilds = 0          !< lists made
    integer(i8) :: weighed = -huge(1)    !< of these, when the balance was looked at last
    integer(i8) :: added = 0, left = 0   !< parcels, on all ranks, since the start
    real(wp) :: mass_added = 0.0_wp, mass_left = 0.0_wp  !< [kg]
    type(outcome_t) :: trouble           !< met while parcels were added; the same on all ranks
  contains
    procedure :: create
    procedure :: add
    procedure :: time_step_limit
    procedure :: next_step_limit
    procedure :: advance
    procedure :: set_reach
    procedure :: largest_stray
    procedure :: make_lists
    procedure :: renew_lists
  end type solids_t

contains

  !> An empty chamber.
  subroutine create(self, comm, chamber, contact, numerics, with_gas, tile_width)
    class(solids_t), intent(out) :: self
    type(communicator_t), intent(in) :: comm
    type(chamber_t), intent(in) :: chamber
    type(contact_settings_t), intent(in) :: contact
    type(des_settings_t), intent(in) :: numerics
    logical, intent(in) :: with_gas         !< whether a gas drives the parcels
    real(wp), intent(in) :: tile_width      !< least width of a tile [m]; 0: as thin as contacts allow

    self%comm = comm
    self%chamber = chamber
    self%contact = contact
    self%numerics = numerics
    self%tile_width = tile_width
    self%laws = new_contact_laws(contact, chamber%materials())
    if (size(self%laws%pair) > 1) allocate (self%parts(size(self%laws%pair)))
    allocate (self%lightest(0:self%laws%materials()), self%smallest(0:self%laws%materials()), source=huge(1.0_wp))
    self%pairs%with_history = self%laws%friction
    self%walls%with_history = self%laws%friction
    self%pairs%with_angles = any(self%laws%pair%rolling%spring) .or. any(self%laws%wall%rolling%spring)
    self%walls%with_angles = self%pairs%with_angles
    if (self%pairs%with_angles) self%history%rows = 6
    self%attract = any(self%laws%pair%cohesion%on)
    self%reach = max(0.0_wp, maxval(self%laws%pair%cohesion%reach), maxval(self%laws%wall%cohesion%reach))
    call self%parcels%create(self%laws%friction, with_gas)
    call self%history%clear()
  end subroutine create

  !> Put parcels into the chamber. All ranks take part; any of them may bring any parcel, but only one.
  subroutine add(self, position, velocity, diameter, weight, density, powder, id)
    class(solids_t), intent(inout) :: self
    real(wp), intent(in) :: position(:,:)     !< (3,n) [m]
    real(wp), intent(in) :: velocity(:,:)     !< (3,n) [m/s]
    real(wp), intent(in) :: diameter(:)       !< (n) of one real particle [m]
    real(wp), intent(in) :: weight(:)         !< (n) real particles in a parcel [-]
    real(wp), intent(in) :: density(:)        !< (n) of the solid [kg/m3]
    integer, intent(in) :: powder(:)          !< (n)
    integer(i8), intent(in) :: id(:)          !< (n) positive, each once

    logical :: moved

    call keep_history(self)
    call self%parcels%append(position, velocity, diameter, weight, density, powder, id)
    self%added = self%added + self%comm%sum(int(size(id), i8))
    self%mass_added = self%mass_added + self%comm%sum(pi/6*sum(weight*density*diameter**3))
    call self%set_reach()
    call self%make_lists(self%trouble)
    if (self%weighed < 0 .and. .not. self%trouble%failed()) then  ! nobody knew the work when tiles were dealt out
      call share_work(self, moved)
      if (moved) call self%make_lists(self%trouble)
    end if
    call start_ways(self)
  end subroutine add

  !> What follows from the sizes of all parcels: the range of contacts, and tiles as wide as that is with the widest skin.
  subroutine set_reach(self)
    class(solids_t), intent(inout) :: self

    real(wp) :: width

    call widen_extremes(self%comm, self%laws, self%parcels, self%largest_radius, self%largest_ratio, self%smallest, &
                        self%lightest)
    if (.not. self%largest_radius > 0.0_wp) return
    self%smallest_radius = minval(self%smallest)
    self%skin = allowed_skin(self, self%skin)
    call self%search%set_levels(self%smallest_radius, self%largest_radius)
    width = max(self%tile_width, 2*self%largest_radius + self%reach + largest_skin(self))
    if (allocated(self%tiles%owner)) then
      if (all(self%tiles%width >= width .or. self%tiles%n == 1)) return
    end if
    self%tiles = new_tiles(self%comm, self%chamber%lower, self%chamber%upper, self%chamber%periodic, [width, width, width])
    self%tilings = self%tilings + 1
  end subroutine set_reach

  !> The skin of the case, or the given one within limits [m].
  pure function allowed_skin(self, skin) result(allowed)
    type(solids_t), intent(in) :: self
    real(wp), intent(in) :: skin  !< [m]
    real(wp) :: allowed

    allowed = self%numerics%skin
    if (is_set(allowed)) return
    allowed = skin_within(self%chamber, 2*self%largest_radius + self%reach, typical_width(self), skin)
  end function allowed_skin

  !> The widest skin there may be [m].
  pure function largest_skin(self) result(skin)
    type(solids_t), intent(in) :: self
    real(wp) :: skin

    skin = max(self%skin, widest_skin*typical_width(self))
  end function largest_skin

  !> How far a parcel may be outside the tiles of its rank: half the skin, however wide that becomes [m].
  pure function largest_stray(self) result(way)
    class(solids_t), intent(in) :: self
    real(wp) :: way

    way = 0.5_wp*largest_skin(self)
  end function largest_stray

  !> Of a parcel, between smallest and largest [m].
  pure function typical_width(self) result(width)
    type(solids_t), intent(in) :: self
    real(wp) :: width

    width = 2*sqrt(self%smallest_radius*self%largest_radius)
  end function typical_width

  !> The longest solids step, from the shortest collision, or swing by attraction, of any two parcels or of one and a wall [s].
  !> The collision of Hertz's law goes with the fifth root of the speed, for which `impact_velocity` stands unless a higher one is
  !> given.
  function time_step_limit(self, speed) result(dt)
    class(solids_t), intent(in) :: self
    real(wp), intent(in), optional :: speed  !< of an approach [m/s]
    real(wp) :: dt

    real(wp) :: fastest

    if (self%added == 0) then
      dt = huge(1.0_wp)
    else
      fastest = self%contact%impact_velocity
      if (present(speed)) fastest = max(fastest, speed)
      dt = min(self%laws%contact_time(self%lightest, self%smallest, fastest), self%laws%swing_time(self%largest_ratio)) &
           /self%numerics%steps_per_collision
    end if
  end function time_step_limit

  !> The longest solids step from now on: that of the shortest collision, or less where a parcel would enter another by
  !> more than a part of the smallest radius before a contact is seen. All ranks take part [s].
  function next_step_limit(self) result(dt)
    class(solids_t), intent(in) :: self
    real(wp) :: dt

    real(wp) :: speed

    speed = self%comm%max(fastest_speed(self%parcels))
    dt = min(self%time_step_limit(speed + max(speed, self%chamber%fastest)), &
             farthest_step*self%smallest_radius/max(speed + self%chamber%fastest, tiny(dt)))
  end function next_step_limit

  !> Go on by `steps` steps of `dt`. All ranks take part and agree on the outcome.
  subroutine advance(self, steps, dt, outcome)
    class(solids_t), intent(inout) :: self
    integer, intent(in) :: steps
    real(wp), intent(in) :: dt  !< [s]
    type(outcome_t), intent(inout) :: outcome

    real(wp) :: fastest, energy, time
    integer :: step

    if (self%trouble%failed()) outcome = self%trouble
    if (outcome%failed() .or. steps == 0 .or. self%added == 0) return
    if (.not. self%step > 0.0_wp) call start(self, dt)
    call add_lead(self%parcels)
    call drift(self%parcels, dt/2, fastest)
    call place_walls(self, dt/2)
    call keep_neighbours(self, dt/2, fastest, .true., outcome)
    do step = 1, steps
      if (outcome%failed()) exit
      time = merge(dt, dt/2, step < steps)
      call push(self, [dt, time], fastest, energy)
      self%time = self%time + dt
      call place_walls(self, time - dt/2)
      call keep_neighbours(self, time, fastest, energy <= huge(1.0_wp) .and. self%walls%through == 0, outcome)
    end do
    call take_lead(self%parcels)
  end subroutine advance

  !> Parcels that start have no step before: their lead is by the forces where they are. No time passes, so no contact slips.
  subroutine start(self, dt)
    class(solids_t), intent(inout) :: self
    real(wp), intent(in) :: dt  !< of the steps that follow [s]

    integer :: columns(2), first

    call begin_step(self, 0.0_wp)
    do first = 1, self%parcels%n, stretch_rows
      columns = [first, min(first + stretch_rows - 1, self%parcels%n)]
      call find_forces(self, columns)
      call start_lead(self%parcels, columns, self%chamber%gravity, dt)
    end do
  end subroutine start

  !> Walls go along with the parcels, which are ahead of the time within a step.
  pure subroutine place_walls(self, ahead)
    class(solids_t), intent(inout) :: self
    real(wp), intent(in) :: ahead  !< [s]

    if (self%chamber%fastest > 0.0_wp) call self%chamber%move_to(self%time + ahead)
  end subroutine place_walls

  !> Forces, kick and drift. A pair is in the row of its lower column, so all forces on a parcel are known once the rows up to its
  !> own are swept: a stretch of parcels moves while it is still in the cache.
  subroutine push(self, times, fastest, energy)
    class(solids_t), intent(inout) :: self
    real(wp), intent(in) :: times(2)          !< of the kick, of the drift [s]
    real(wp), intent(out) :: fastest, energy  !< see kick_and_drift

    integer :: columns(2), first

    self%step = self%step + 1
    call begin_step(self, times(1))
    fastest = 0.0_wp
    energy = 0.0_wp
    do first = 1, self%parcels%n, stretch_rows
      columns = [first, min(first + stretch_rows - 1, self%parcels%n)]
      if (any_tight(self%pairs, self%parts)) call self%ahead%read_stretch(first, self%parcels)
      call find_forces(self, columns)
      call kick_and_drift(self%parcels, columns, self%chamber%gravity, times, fastest, energy)
    end do
  end subroutine push

  subroutine begin_step(self, dt)
    class(solids_t), intent(inout) :: self
    real(wp), intent(in) :: dt  !< [s]

    logical :: chosen

    call self%laws%set_step(dt)
    chosen = self%ghosts%needed .and. .not. self%attract .and. are_due(self%pairs, self%parts)
    call begin_pairs(self%list, self%pairs, self%parts, self%parcels%state, [dt*self%speed, self%skin, typical_width(self)])
    if (chosen) call self%ghosts%watch(self%parcels, second_of_pairs(self%pairs, self%parts, self%parcels%n_all()))
    call self%parcels%make_ring(max(self%list%window, widest_window(self%pairs, self%parts)))
    self%walls%through = 0
    call self%walls%begin_step(self%step, self%travelled + self%chamber%way_since(self%listed_at))
  end subroutine begin_step

  !> Contact forces and torques of the pairs in some rows, and of walls on these parcels.
  subroutine find_forces(self, columns)
    class(solids_t), intent(inout) :: self
    integer, intent(in) :: columns(2)  !< first and last

    call sweep_rows(self%laws, columns(2), self%pairs, self%parts, self%parcels)
    call attract_rows(self%laws, self%list, self%parts, columns, self%parcels)
    call self%walls%take_parcels(columns(2))
    call self%walls%sweep(self%chamber, self%laws, self%parcels)
    if (any(self%laws%wall%cohesion%on)) call attract_walls(self%laws, self%chamber, self%walls, self%parcels)
  end subroutine find_forces

  !> After a drift: make new lists if some parcel or wall may have gone half the skin, else refresh the ghosts.
  !> The largest speed bounds the way gone; the ways themselves are looked at only when the bound is used up.
  subroutine keep_neighbours(self, time, fastest, sound, outcome)
    class(solids_t), intent(inout) :: self
    real(wp), intent(in) :: time      !< of the drift [s]
    real(wp), intent(in) :: fastest   !< square of the largest speed on this rank [m2/s2]
    logical, intent(in) :: sound      !< whether this rank's parcels are where they may be
    type(outcome_t), intent(inout) :: outcome

    real(wp) :: largest(2)
    logical :: some_ghosts

    largest = [merge(fastest, 0.0_wp, sound), merge(0.0_wp, 1.0_wp, sound)]
    if (self%comm%size > 1) largest = self%comm%max(largest)
    if (largest(2) > 0.0_wp) then
      call find_trouble(self%comm, self%chamber, self%parcels, self%time, outcome)
      return
    end if
    self%speed = sqrt(largest(1))
    self%travelled = self%travelled + time*self%speed
    call self%pairs%note_way(time*self%speed)
    if (allocated(self%parts)) call self%parts%pairs%note_way(time*self%speed)
    if (self%travelled > 0.5_wp*self%skin) self%travelled = self%comm%max(farthest(self%parcels))
    ! rather a step too early than looking at the ways in every step
    if (max(self%travelled, self%chamber%way_since(self%listed_at)) + time*self%speed > 0.5_wp*self%skin) then
      call self%renew_lists(outcome)
    else
      some_ghosts = .not. (self%attract .or. are_due(self%pairs, self%parts))
      call self%ghosts%refresh(self%parcels, watched=some_ghosts)
    end if
  end subroutine keep_neighbours

  !> Take the slips out of the present lists.
  subroutine keep_history(self)
    class(solids_t), intent(inout) :: self

    call self%history%clear()
    if (self%parcels%rotation .and. self%rebuilds > 0) then
      if (allocated(self%parts)) self%pairs = gathered(self%parts)
      call self%history%collect(self%pairs, self%walls, self%parcels, self%step)
    end if
  end subroutine keep_history

  !> New lists for the parcels where they are. All ranks take part.
  subroutine renew_lists(self, outcome)
    class(solids_t), intent(inout) :: self
    type(outcome_t), intent(inout) :: outcome

    real(wp) :: listed(2)
    logical :: moved

    listed = self%comm%sum(real([self%list%entries, self%parcels%n], wp))
    self%skin = allowed_skin(self, fitting_skin(self%skin, typical_width(self), listed(1)/max(listed(2), 1.0_wp)))
    call keep_history(self)
    call share_work(self, moved)
    call self%make_lists(outcome)
    call start_ways(self)
  end subroutine renew_lists

  !> Look at the balance of work now and then.
  subroutine share_work(self, moved)
    class(solids_t), intent(inout) :: self
    logical, intent(out) :: moved  !< whether tiles have changed hands

    moved = .false.
    if (self%comm%size == 1 .or. self%rebuilds < self%weighed + lists_per_look) return
    self%weighed = self%rebuilds
    call rebalance(self%tiles, self%parcels, self%list, self%walls%parcel(1:self%walls%entries), moved)
    if (moved) self%tilings = self%tilings + 1
  end subroutine share_work

  !> From here on parcels may go half the skin.
  pure subroutine start_ways(self)
    class(solids_t), intent(inout) :: self

    call note_places(self%parcels)
    self%travelled = 0.0_wp
    self%listed_at = self%chamber%time
  end subroutine start_ways

  !> The lists themselves, with the slips kept in `history`; for `renew_lists` and the reading of restarts.
  subroutine make_lists(self, outcome)
    class(solids_t), intent(inout) :: self
    type(outcome_t), intent(inout) :: outcome

    integer, allocatable :: order(:), place(:)
    integer(i8) :: gone
    integer :: i
    real(wp) :: mass

    self%range = 2*self%largest_radius + self%reach + self%skin
    call check_period(self%chamber, self%range, outcome)
    call find_trouble(self%comm, self%chamber, self%parcels, self%time, outcome)
    if (outcome%failed()) return
    call settle_owners(self%comm, self%tiles, self%chamber, self%parcels, self%history, gone, mass)
    self%left = self%left + gone
    self%mass_left = self%mass_left + mass
    allocate (order(self%parcels%n), place(self%parcels%n))
    call self%search%sort_own(self%parcels, self%skin + self%reach, order)
    call self%parcels%reorder(order)
    place(order) = [(i, i=1, size(order))]
    call self%history%follow(place)
    call self%ghosts%invite(self%tiles, self%range, self%parcels, with_powder=allocated(self%parts))
    call self%search%build(self%parcels, self%ghosts%near, self%skin + self%reach, self%list)
    call self%ahead%note(self%list, self%parcels)
    call self%pairs%take_all(self%list)
    call self%walls%build(self%chamber, self%parcels, 0.5_wp*self%skin + self%reach)
    if (self%parcels%rotation) call self%history%restore(self%list, self%pairs, self%walls, self%parcels, self%step)
    if (allocated(self%parts)) then
      call deal(self%list, self%pairs, self%laws, self%parcels%powder(1:self%parcels%n_all()), self%parts)
    end if
    self%rebuilds = self%rebuilds + 1
  end subroutine make_lists

end module solids

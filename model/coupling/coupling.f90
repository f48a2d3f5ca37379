!> What gas and parcels do to each other over one gas step.
!>
!> One real particle of mass m, volume V and diameter d at velocity v feels, beside contacts,
!>
!>   m dv/dt = m g - V grad p + beta (u - v),    beta = 3 pi mu d eps F(Re, eps),    Re = rho eps |u - v| d/mu,
!>
!> with the void fraction eps, the gas velocity u and its density rho taken from the cells by the weights w_c of module mapping;
!> W particles make a parcel. The void fraction of a cell is eps = 1 - sum w_c W V/V_cell.
!>
!> How a particle answers drag over a step, and why no step is too long, is told in drag_response: its mean drag is
!> D = beta_eff (u' - v_hat), u' the gas velocity at the end of the step. So the gas gets sum w_c W beta_eff and
!> sum w_c W beta_eff v_hat, and once it has converged the parcels get D, with the same weights: what the gas takes is
!> what the parcels give, to round-off.
!>
!> Where walls block the gas a cell counts, and is as large, as it is open: see open_weights.
module coupling
  use boxes, only: boxes_t
  use communicator, only: communicator_t
  use constants, only: pi, is_set
  use coupling_settings, only: coupling_settings_t
  use drag_response, only: drag_t, particles_t, new_drag, block
  use gas, only: gas_t
  use gas_settings, only: gas_settings_t
  use gas_view, only: gas_view_t, eps_lane, velocity_lane, gradient_lane, density_lane
  use kinds, only: wp
  use local_sizes, only: local_sizes_t
  use mapping, only: locate, interpolate, deposit, deposit_sources, lanes, source_lanes, mapping_variance
  use mesh, only: mesh_t
  use open_space, only: open_space_t
  use open_weights, only: open_weights_t
  use parcels, only: parcels_t, velocity_row, mass_row, drive_row, drag_row, before_row
  use tiles, only: tiles_t
  use spreading, only: spreading_t
  use transfer, only: transfer_t, new_transfer
  use window, only: window_t, new_window
  implicit none
  private
  public :: coupling_t, exchange_t

  integer, parameter :: duration_row = before_row + 3  !< of parcels%coupled: length of the last gas step, 0 if none [s]

  ! Components of the field that parcels add to: 1:3 beta_eff v_hat, 4 beta_eff.
  integer, parameter :: coefficient_lane = 4

  !> What was exchanged in the last step, over all ranks.
  type :: exchange_t
    real(wp) :: solids_volume = 0.0_wp      !< in the parcels [m3]
    real(wp) :: clipped_volume = 0.0_wp     !< of it that the gas does not see, because of the least void fraction [m3]
    real(wp) :: least_void_fraction = 1.0_wp  !< of all cells, before clipping [-]
    integer :: worst_cell(3) = 0            !< where that is, counted in the whole grid
    integer :: clipped_cells = 0
    real(wp) :: drag(3) = 0.0_wp            !< on all parcels [N]
    real(wp) :: momentum_residual = 0.0_wp  !< |force on parcels + force on gas| over the sum of all W |D| [-]
    real(wp) :: mean_slip = 0.0_wp          !< |u - v|, mean over the volume of the parcels [m/s]
  end type exchange_t

  type :: coupling_t
    private
    type(exchange_t), public :: exchange    !< of the last step
    type(communicator_t) :: comm
    type(mesh_t) :: mesh
    type(boxes_t) :: boxes
    type(drag_t) :: drag_law
    real(wp) :: minimum_void_fraction       !< [-]
    real(wp) :: gravity(3)                  !< [m/s2]
    integer, allocatable :: owner(:)        !< (tiles) ranks the window was made for
    real(wp) :: slack                       !< [m]
    type(window_t) :: window
    type(transfer_t) :: transfer
    logical :: cell_centred                 !< whether a parcel touches its cell only
    type(spreading_t), allocatable :: spreading  !< over more cells; exists with a width
    type(local_sizes_t), allocatable, public :: sizes  !< of the particles around each; exists with polydispersity
    type(gas_view_t) :: view                !< what parcels read
    real(wp), allocatable :: box_source(:,:,:,:)  !< (source_lanes,n1,n2,n3) what parcels add to
    real(wp), allocatable :: box_volume(:,:,:)   !< (n1,n2,n3) solids [m3]
    real(wp), allocatable :: cell_volume(:,:,:)  !< (n1,n2,n3) of the cells of my box, of closed ones all of it [m3]
    type(open_weights_t), allocatable :: weights  !< exist if walls block the gas
    real(wp), allocatable :: source(:,:)         !< (source_lanes,window cells)
    real(wp), allocatable :: volume(:)           !< (window cells) [m3]
    integer :: n = 0                             !< parcels whose places are known
    integer, allocatable :: corner(:)            !< (n) and
    real(wp), allocatable :: fraction(:,:)       !< (3,n) the places, see mapping
    real(wp), allocatable :: response(:,:)       !< (4,n) v_hat [m/s] and beta_eff [kg/s] of each real particle
  contains
    procedure :: create
    procedure :: narrow
    procedure :: follow_tiles
    procedure :: map_void_fraction
    procedure :: prepare
    procedure :: drive
  end type coupling_t

contains

  subroutine create(self, mesh, boxes, settings, gas_settings, gravity)
    class(coupling_t), intent(out) :: self
    type(mesh_t), intent(in) :: mesh
    type(boxes_t), intent(in) :: boxes
    type(coupling_settings_t), intent(in) :: settings
    type(gas_settings_t), intent(in) :: gas_settings
    real(wp), intent(in) :: gravity(3)  !< [m/s2]

    self%comm = boxes%comm
    self%mesh = mesh
    self%boxes = boxes
    self%minimum_void_fraction = settings%minimum_void_fraction
    self%drag_law = new_drag(settings, gas_settings%density, gas_settings%viscosity, gas_settings%density_law == 'ideal')
    self%gravity = gravity
    associate (n => boxes%n)
      call self%view%create(n)
      allocate (self%box_source(source_lanes, n(1), n(2), n(3)), source=0.0_wp)
      allocate (self%box_volume(n(1), n(2), n(3)), source=0.0_wp)
      allocate (self%cell_volume(n(1), n(2), n(3)), source=mesh%volumes(boxes%lo, boxes%hi))
    end associate
    allocate (self%corner(0), self%fraction(3, 0), self%response(4, 0))
    self%cell_centred = settings%mapping == 'cell'
    if (is_set(settings%width)) then
      allocate (self%spreading)
      call self%spreading%create(boxes, mesh, settings%width, mapping_variance(settings%mapping), lanes)
    end if
    if (settings%polydispersity == 'none') return
    allocate (self%sizes)
    call self%sizes%create(boxes)
  end subroutine create

  !> Leave to the gas what is open.
  subroutine narrow(self, space)
    class(coupling_t), intent(inout) :: self
    type(open_space_t), intent(in) :: space

    allocate (self%weights)
    call self%weights%create(self%boxes%n, space)
    where (self%weights%open > 0.0_wp) self%cell_volume = self%weights%open*self%cell_volume
  end subroutine narrow

  !> Make the window and the plan of transfer anew if the tiles have other owners than before; all ranks together,
  !> after the parcels have gone to their new owners.
  subroutine follow_tiles(self, tiles, slack)
    class(coupling_t), intent(inout) :: self
    type(tiles_t), intent(in) :: tiles
    real(wp), intent(in) :: slack  !< how far a parcel may be outside the tiles of its rank, the same on all [m]

    real(wp) :: corners(3, 2, size(tiles%mine))
    integer :: i

    if (allocated(self%owner)) then
      if (slack <= self%slack .and. all(self%owner == tiles%owner)) return
    end if
    self%owner = tiles%owner
    self%slack = slack
    do i = 1, size(tiles%mine)
      call tiles%bounds(tiles%mine(i), corners(:, 1, i), corners(:, 2, i))
      corners(:, 1, i) = self%mesh%in_cells(corners(:, 1, i) - slack)
      corners(:, 2, i) = self%mesh%in_cells(corners(:, 2, i) + slack)
    end do
    self%window = new_window(self%mesh%n, self%mesh%periodic, corners)
    call new_transfer(self%boxes, self%window, lanes, self%transfer)
    call self%view%follow(self%window%cells())
    if (allocated(self%source)) deallocate (self%source, self%volume)
    allocate (self%source(source_lanes, self%window%cells()), source=0.0_wp)
    allocate (self%volume(self%window%cells()), source=0.0_wp)
    self%n = 0
    if (allocated(self%weights)) call self%weights%see(self%spreading, self%transfer, self%window)
  end subroutine follow_tiles

  !> Give the gas the void fraction of the parcels where they now are; prepare and drive use the same places.
  subroutine map_void_fraction(self, parcels, gas)
    class(coupling_t), intent(inout) :: self
    type(parcels_t), intent(in) :: parcels
    type(gas_t), intent(inout) :: gas

    integer :: outside, n(3)
    real(wp) :: total, volume(parcels%n)

    call reserve(self, parcels%n)
    call locate(self%mesh, self%window, parcels%state, self%corner(:self%n), self%fraction(:, :self%n), outside)
    if (outside > 0) error stop 'coupling: a parcel is nowhere, or beyond the cells around the tiles of its rank'
    if (self%cell_centred) self%fraction(:, :self%n) = anint(self%fraction(:, :self%n))
    self%volume = 0.0_wp
    if (allocated(self%weights)) call self%weights%find_shares(self%window, self%corner(:self%n), self%fraction(:, :self%n))
    volume = pi/6.0_wp*parcels%weight(:self%n)*parcels%diameter(:self%n)**3
    total = sum(volume)
    if (allocated(self%weights)) volume = volume*self%weights%share
    call deposit(self%window, self%corner(:self%n), self%fraction(:, :self%n), volume, self%volume)
    self%box_volume = 0.0_wp
    call self%transfer%scatter_add(1, self%volume, self%box_volume)
    if (allocated(self%spreading)) call self%spreading%give(1, self%box_volume)
    if (allocated(self%weights)) self%box_volume = self%weights%open*self%box_volume
    self%box_volume = 1.0_wp - self%box_volume/self%cell_volume
    call record_clipping(self, total)
    n = self%boxes%n
    gas%eps(1:n(1), 1:n(2), 1:n(3)) = max(self%box_volume, self%minimum_void_fraction)
    if (allocated(self%sizes)) call self%sizes%measure(self%window, self%transfer, parcels, self%corner(:self%n), &
                                                       self%fraction(:, :self%n), self%spreading)
  end subroutine map_void_fraction

  !> Room for the places of n parcels.
  pure subroutine reserve(self, n)
    class(coupling_t), intent(inout) :: self
    integer, intent(in) :: n

    self%n = n
    if (n <= size(self%corner)) return
    deallocate (self%corner, self%fraction, self%response)
    allocate (self%corner(n + n/4), self%fraction(3, n + n/4), self%response(4, n + n/4))
  end subroutine reserve

  !> What the least void fraction hides from the gas; box_volume holds the void fraction as it is.
  subroutine record_clipping(self, solids_volume)
    class(coupling_t), intent(inout) :: self
    real(wp), intent(in) :: solids_volume  !< of this rank [m3]

    real(wp) :: sums(3), least
    integer :: a, worst(3)

    associate (eps => self%box_volume, least_wanted => self%minimum_void_fraction, exchange => self%exchange)
      sums(1) = solids_volume
      sums(2) = sum((least_wanted - eps)*self%cell_volume, eps < least_wanted)
      sums(3) = count(eps < least_wanted)
      sums = self%comm%sum(sums)
      least = minval(eps)
      exchange%least_void_fraction = self%comm%min(least)
      worst = 0
      if (least <= exchange%least_void_fraction) worst = minloc(eps) + self%boxes%lo - 1
      do a = 1, 3
        exchange%worst_cell(a) = self%comm%max(worst(a))
      end do
      exchange%solids_volume = sums(1)
      exchange%clipped_volume = sums(2)
      exchange%clipped_cells = nint(sums(3))
    end associate
  end subroutine record_clipping

  !> Give the gas the drag coefficient and the drag source of a step of length dt [s].
  !> The parcels are where map_void_fraction saw them; a step that is tried again shorter is prepared again.
  subroutine prepare(self, parcels, gas, dt, as_seen)
    class(coupling_t), intent(inout) :: self
    type(parcels_t), intent(in) :: parcels
    type(gas_t), intent(inout) :: gas
    real(wp), intent(in) :: dt
    logical, intent(in) :: as_seen    !< whether the gas is what it was when last looked at, here or to drive, but for its void
                                      !< fraction

    integer :: first, n(3), a

    if (parcels%n /= self%n) error stop 'coupling: prepare without map_void_fraction'
    if (as_seen .and. self%view%complete .and. .not. allocated(self%spreading)) then
      call self%view%see_void_fraction(gas, self%weights, self%transfer)
    else  ! the last digits of what is spread depend on what else is, and a restart has to look at all
      call self%view%see(gas, self%weights, self%spreading, self%transfer)
    end if
    self%source = 0.0_wp
    do first = 1, self%n, block
      call respond(self, parcels, dt, first, min(self%n - first + 1, block))
    end do
    self%box_source = 0.0_wp
    call self%transfer%scatter_add(source_lanes, self%source, self%box_source)
    if (allocated(self%spreading)) call self%spreading%give(source_lanes, self%box_source)
    if (allocated(self%weights)) call self%weights%narrow(self%box_source)
    n = self%boxes%n
    gas%drag(1:n(1), 1:n(2), 1:n(3)) = self%box_source(coefficient_lane, :, :, :)
    do a = 1, 3
      gas%drag_source(a, 1:n(1), 1:n(2), 1:n(3)) = self%box_source(a, :, :, :)
    end do
  end subroutine prepare

  !> v_hat and beta_eff of a block of parcels, and their share of the drag on the cells.
  subroutine respond(self, parcels, dt, first, n)
    class(coupling_t), intent(inout) :: self
    type(parcels_t), intent(in) :: parcels
    real(wp), intent(in) :: dt         !< [s]
    integer, intent(in) :: first, n    !< parcels first to first + n - 1

    type(particles_t) :: particles
    real(wp) :: value(lanes, block), source(source_lanes, block)
    integer :: i, k

    associate (corner => self%corner(first:first + n - 1), fraction => self%fraction(:, first:first + n - 1))
      call look(self, first, n, value)
      if (any(value(eps_lane, :n) < 0.999_wp*self%minimum_void_fraction)) then
        error stop 'coupling: a parcel reads cells that its rank does not hold'
      end if
      call meet(parcels, self%gravity, first, n, value, particles)
      if (self%drag_law%density_varies) particles%density(:n) = value(density_lane, :n)
      if (allocated(self%sizes)) then
        particles%mean_diameter(:n) = self%sizes%mean(first:first + n - 1)
        particles%spread(:n) = self%sizes%spread(first:first + n - 1)
      end if
      call self%drag_law%respond(dt, particles)
      do i = 1, n
        k = first + i - 1
        self%response(1:3, k) = parcels%state(velocity_row:velocity_row + 2, k) + particles%lead(:, i)
        self%response(4, k) = particles%coefficient(i)
        source(coefficient_lane, i) = parcels%weight(k)*particles%coefficient(i)
        if (allocated(self%weights)) then
          if (.not. self%weights%share(k) > 0.0_wp) self%response(4, k) = 0.0_wp  ! there is no gas
          source(coefficient_lane, i) = self%weights%share(k)*source(coefficient_lane, i)
        end if
        source(1:3, i) = source(coefficient_lane, i)*self%response(1:3, k)
      end do
      call deposit_sources(self%window, corner, fraction, source(:, :n), self%source)
    end associate
  end subroutine respond

  !> The gas at a block of parcels; without gas around nothing moves there.
  pure subroutine look(self, first, n, value)
    class(coupling_t), intent(in) :: self
    integer, intent(in) :: first, n               !< parcels first to first + n - 1
    real(wp), intent(inout) :: value(lanes, block)

    integer :: i

    call interpolate(self%window, self%corner(first:first + n - 1), self%fraction(:, first:first + n - 1), self%view%field, &
                     value(:, :n))
    if (.not. allocated(self%weights)) return
    do i = 1, n
      associate (share => self%weights%share(first + i - 1))
        value(:, i) = share*value(:, i)
        if (.not. share > 0.0_wp) value(eps_lane, i) = 1.0_wp
      end associate
    end do
  end subroutine look

  !> What the real particles of a block of parcels meet. Beside drag and its pressure gradient they do what they did in
  !> the last step; those that have none fall.
  pure subroutine meet(parcels, gravity, first, n, value, particles)
    type(parcels_t), intent(in) :: parcels
    real(wp), intent(in) :: gravity(3)            !< [m/s2]
    integer, intent(in) :: first, n               !< parcels first to first + n - 1
    real(wp), intent(in) :: value(lanes, block)   !< of the gas, at the parcels
    type(particles_t), intent(inout) :: particles

    integer :: i, k

    particles%n = n
    do i = 1, n
      k = first + i - 1
      particles%diameter(i) = parcels%diameter(k)
      particles%inverse_mass(i) = parcels%weight(k)*parcels%state(mass_row, k)
      particles%eps(i) = value(eps_lane, i)
      associate (v => parcels%state(velocity_row:velocity_row + 2, k), last => parcels%coupled(:, k))
        particles%slip(:, i) = value(velocity_lane:velocity_lane + 2, i) - v
        if (last(duration_row) > 0.0_wp) then
          particles%acceleration(:, i) = (v - last(before_row:before_row + 2))/last(duration_row) &
            - last(drag_row:drag_row + 2)/particles%eps(i)
        else
          particles%acceleration(:, i) = gravity - value(gradient_lane:gradient_lane + 2, i)*specific_volume(parcels, k)
        end if
      end associate
    end do
  end subroutine meet

  !> Volume over mass of the powder of a parcel [m3/kg].
  pure function specific_volume(parcels, k)
    type(parcels_t), intent(in) :: parcels
    integer, intent(in) :: k
    real(wp) :: specific_volume

    specific_volume = pi/6.0_wp*parcels%diameter(k)**3*parcels%weight(k)*parcels%state(mass_row, k)
  end function specific_volume

  !> Give the parcels what the gas does to them over the step for which it has converged, and check the ledger.
  subroutine drive(self, parcels, gas, dt)
    class(coupling_t), intent(inout) :: self
    type(parcels_t), intent(inout) :: parcels
    type(gas_t), intent(in) :: gas
    real(wp), intent(in) :: dt  !< as prepared [s]

    integer :: first
    real(wp) :: sums(5)

    call self%view%see(gas, self%weights, self%spreading, self%transfer)
    sums = 0.0_wp
    do first = 1, self%n, block
      call drive_block(self, parcels, dt, first, min(self%n - first + 1, block), sums)
    end do
    call record_exchange(self, gas, sums)
  end subroutine drive

  subroutine drive_block(self, parcels, dt, first, n, sums)
    class(coupling_t), intent(in) :: self
    type(parcels_t), intent(inout) :: parcels
    real(wp), intent(in) :: dt             !< [s]
    integer, intent(in) :: first, n        !< parcels first to first + n - 1
    real(wp), intent(inout) :: sums(5)     !< 1:3 W D [N], 4 W |D| [N], 5 W V |u - v| [m4/s]

    real(wp) :: value(lanes, block), u(3), force(3), inverse_mass, volume_per_mass
    integer :: i, k

    call look(self, first, n, value)
    do i = 1, n
      k = first + i - 1
      inverse_mass = parcels%weight(k)*parcels%state(mass_row, k)
      volume_per_mass = specific_volume(parcels, k)
      u = value(velocity_lane:velocity_lane + 2, i)
      force = self%response(4, k)*(u - self%response(1:3, k))
      sums(1:3) = sums(1:3) + parcels%weight(k)*force
      sums(4) = sums(4) + parcels%weight(k)*sqrt(sum(force**2))
      sums(5) = sums(5) + parcels%weight(k)*volume_per_mass/inverse_mass &
        *sqrt(sum((u - parcels%state(velocity_row:velocity_row + 2, k))**2))
      associate (coupled => parcels%coupled(:, k))
        coupled(drag_row:drag_row + 2) = force*inverse_mass
        coupled(drive_row:drive_row + 2) = self%gravity + force*inverse_mass &
          - value(gradient_lane:gradient_lane + 2, i)*volume_per_mass
        coupled(before_row:before_row + 2) = parcels%state(velocity_row:velocity_row + 2, k)
        coupled(duration_row) = dt
      end associate
    end do
  end subroutine drive_block

  !> Compare what the parcels got with what the gas lost.
  subroutine record_exchange(self, gas, sums)
    class(coupling_t), intent(inout) :: self
    type(gas_t), intent(in) :: gas
    real(wp), intent(in) :: sums(5)  !< of this rank, see drive_block

    real(wp) :: total(5), gap(3)

    total = self%comm%sum(sums)
    gap = total(1:3) + gas%drag_total()
    self%exchange%drag = total(1:3)
    self%exchange%momentum_residual = 0.0_wp
    if (total(4) > 0.0_wp) self%exchange%momentum_residual = sqrt(sum(gap**2))/total(4)
    self%exchange%mean_slip = 0.0_wp
    if (total(5) > 0.0_wp) self%exchange%mean_slip = total(5)/self%exchange%solids_volume
  end subroutine record_exchange

end module coupling

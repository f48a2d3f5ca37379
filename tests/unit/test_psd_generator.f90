!> From powders, weightings and fills to parcels: the same bits where they must be, mass, places, refusals.
program test_psd_generator
  use check, only: expect, expect_close, finish
  use cloud, only: cloud_t
  use constants, only: pi
  use generator, only: generate
  use kinds, only: wp, i8
  use outcome, only: outcome_t, exit_input
  use parcels_settings, only: parcels_settings_t, fill_settings_t
  use powder_settings, only: powder_settings_t
  use size_audit, only: size_audit_t, write_audit
  use vessel, only: vessel_t
  implicit none

  real(wp), parameter :: um = 1.0e-6_wp

  call one_particle_each()
  call same_for_a_seed()
  call a_bed()
  call two_powders()
  call too_much()
  call refusals()
  call finish()

contains

  !> A box of 10 x 20 x 8 mm with periodic sides in z.
  pure function thin_box() result(vessel)
    type(vessel_t) :: vessel

    vessel = vessel_t([0.0_wp, 0.0_wp, 0.0_wp], [0.010_wp, 0.020_wp, 0.008_wp], [.false., .false., .true.])
  end function thin_box

  pure function beads(distribution) result(powder)
    character(len=*), intent(in) :: distribution
    type(powder_settings_t) :: powder

    powder%id = 'beads'
    powder%density = 2500.0_wp
    powder%distribution = distribution
    powder%mean_diameter = 500*um
    powder%standard_deviation = 125*um
    powder%minimum_diameter = 250*um
    powder%maximum_diameter = 800*um
  end function beads

  !> The lower half of the thin box, with a mass.
  pure function lower_half(mass) result(fill)
    real(wp), intent(in) :: mass  !< [kg]
    type(fill_settings_t) :: fill

    fill%id = 'bed'
    fill%powder = 1
    fill%lower = [0.0_wp, 0.0_wp, 0.0_wp]
    fill%upper = [0.010_wp, 0.010_wp, 0.008_wp]
    fill%mass = mass
    fill%velocity = [0.0_wp, -0.1_wp, 0.0_wp]
  end function lower_half

  !> Parcels of one powder in the lower half of the thin box.
  subroutine make(distribution, weighting, size, mass, cloud, outcome)
    character(len=*), intent(in) :: distribution, weighting
    real(wp), intent(in) :: size  !< weight or diameter
    real(wp), intent(in) :: mass  !< [kg]
    type(cloud_t), intent(out) :: cloud
    type(outcome_t), intent(out) :: outcome

    type(parcels_settings_t) :: settings
    type(size_audit_t), allocatable :: audits(:)

    settings%weighting = weighting
    settings%weight = size
    settings%diameter = size
    call generate([beads(distribution)], settings, [lower_half(mass)], thin_box(), cloud, audits, outcome)
  end subroutine make

  pure function same_bits(a, b) result(same)
    type(cloud_t), intent(in) :: a, b
    logical :: same

    same = a%n == b%n
    if (.not. same) return
    same = all(abs(a%position - b%position) <= 0.0_wp) .and. all(abs(a%velocity - b%velocity) <= 0.0_wp) .and. &
           all(abs(a%diameter - b%diameter) <= 0.0_wp) .and. all(abs(a%weight - b%weight) <= 0.0_wp) .and. &
           all(abs(a%contact_diameter - b%contact_diameter) <= 0.0_wp) .and. all(a%id == b%id)
  end function same_bits

  !> W = 1 is DEM: with SSW for any powder, with SSP for one size.
  subroutine one_particle_each()
    type(cloud_t) :: dem, ssw, ssp
    type(outcome_t) :: outcome(5)

    call make('single', 'dem', 0.0_wp, 0.5e-3_wp, dem, outcome(1))
    call make('single', 'ssw', 1.0_wp, 0.5e-3_wp, ssw, outcome(2))
    call make('single', 'ssp', 500*um, 0.5e-3_wp, ssp, outcome(3))
    call expect(.not. any([outcome(1)%failed(), outcome(2)%failed(), outcome(3)%failed()]), 'one size: parcels are made')
    call expect(dem%n == nint(0.5e-3_wp/(2500*pi/6*(500*um)**3)), 'one size: as many as the mass asks')
    call expect(same_bits(dem, ssw), 'one size: SSW with W = 1 is DEM, bit for bit')
    call expect(same_bits(dem, ssp), 'one size: SSP with D = d is DEM, bit for bit')
    call expect(all(abs(ssp%weight - 1.0_wp) <= 0.0_wp) .and. all(abs(ssp%contact_diameter - 500*um) <= 0.0_wp), &
                'one size: SSP with D = d has the weight 1 and the diameter d')
    call make('log_normal', 'dem', 0.0_wp, 0.5e-3_wp, dem, outcome(4))
    call make('log_normal', 'ssw', 1.0_wp, 0.5e-3_wp, ssw, outcome(5))
    call expect(dem%n > 1000 .and. same_bits(dem, ssw), 'log-normal: SSW with W = 1 is DEM, bit for bit')
  end subroutine one_particle_each

  subroutine same_for_a_seed()
    type(parcels_settings_t) :: settings
    type(cloud_t) :: first, again, other
    type(size_audit_t), allocatable :: audits(:)
    type(outcome_t) :: outcome

    call generate([beads('log_normal')], settings, [lower_half(0.2e-3_wp)], thin_box(), first, audits, outcome)
    call generate([beads('log_normal')], settings, [lower_half(0.2e-3_wp)], thin_box(), again, audits, outcome)
    settings%seed = 2
    call generate([beads('log_normal')], settings, [lower_half(0.2e-3_wp)], thin_box(), other, audits, outcome)
    call expect(same_bits(first, again), 'a seed gives the same parcels again')
    call expect(other%n == first%n, 'another seed gives as many parcels')
    call expect(.not. same_bits(first, other), 'another seed gives others')
  end subroutine same_for_a_seed

  !> SSW and SSP of one mass: within half a parcel, without overlap, ids from 1, velocities as asked.
  subroutine a_bed()
    type(cloud_t) :: cloud
    type(outcome_t) :: outcome
    integer :: i

    do i = 1, 2
      if (i == 1) call make('log_normal', 'ssw', 8.0_wp, 1.0e-3_wp, cloud, outcome)
      if (i == 2) call make('log_normal', 'ssp', 1035.07_wp*um, 1.0e-3_wp, cloud, outcome)
      call expect(.not. outcome%failed(), 'a bed is made at a solids fraction of 0.5')
      call expect(abs(sum(2500*pi/6*cloud%diameter**3*cloud%weight) - 1.0e-3_wp) <= 0.51e-3_wp/cloud%n, &
                  'its mass is right to half a parcel')
      call expect(abs(cloud%n - 689) <= 1, 'SSW and SSP have as many parcels where D^3 = W <d^3>')
      call expect_close(sum(cloud%diameter**3*cloud%weight)/sum(cloud%diameter**2*cloud%weight), 542.963_wp*um, 1.0e-3_wp, &
                        'its Sauter mean is that of the powder')
      call expect_close(sum(cloud%diameter*cloud%weight)/sum(cloud%weight), 492.777_wp*um, 1.0e-3_wp, &
                        'its number mean is that of the powder')
      call expect(narrowest_gap(cloud) > 0.0_wp, 'no parcels overlap')
      call expect(all(cloud%position(2, :) + 0.5_wp*cloud%contact_diameter <= 0.010_wp + 1.0e-15_wp), 'none is above its box')
      call expect(all(cloud%id == [(int(i, i8), i=1, cloud%n)]), 'ids count from 1')
      call expect(all(abs(cloud%velocity(2, :) + 0.1_wp) <= 0.0_wp), 'velocities are those of the fill')
    end do
  end subroutine a_bed

  !> The narrowest gap between two parcels [m].
  function narrowest_gap(cloud) result(gap)
    type(cloud_t), intent(in) :: cloud
    real(wp) :: gap

    type(vessel_t) :: vessel
    integer :: i, j

    vessel = thin_box()
    gap = huge(1.0_wp)
    do i = 1, cloud%n
      do j = 1, i - 1
        gap = min(gap, norm2(vessel%shortest(cloud%position(:, i) - cloud%position(:, j))) - &
                  0.5_wp*(cloud%contact_diameter(i) + cloud%contact_diameter(j)))
      end do
    end do
  end function narrowest_gap

  !> Two powders mixed in one box, one by mass and one by number, and what the audit says of each.
  subroutine two_powders()
    type(powder_settings_t) :: powders(2)
    type(fill_settings_t) :: fills(2)
    type(parcels_settings_t) :: settings
    type(cloud_t) :: cloud
    type(size_audit_t), allocatable :: audits(:)
    type(outcome_t) :: outcome
    integer :: unit, lines, status
    character(len=80) :: line, message

    powders = [beads('log_normal'), beads('single')]
    powders(2)%id = 'lead'
    powders(2)%density = 11340.0_wp
    fills = [lower_half(0.3e-3_wp), lower_half(1.0_wp)]
    fills(2)%id = 'shot'
    fills(2)%powder = 2
    fills(2)%mass = -huge(1.0_wp)
    fills(2)%number = 100
    settings%weighting = 'ssw'
    settings%weight = 2.0_wp
    call generate(powders, settings, fills, thin_box(), cloud, audits, outcome)
    call expect(.not. outcome%failed(), 'two powders are placed in one box')
    call expect(narrowest_gap(cloud) > 0.0_wp, 'two powders: no parcels overlap')
    call expect(count(cloud%powder == 2) == 100 .and. all(pack(cloud%fill, cloud%powder == 2) == 2), &
                'two powders: as many of the second as asked')
    call expect(all(abs(pack(cloud%density, cloud%powder == 2) - 11340.0_wp) <= 0.0_wp), 'two powders: each has its density')
    call expect(audits(2)%parcels == 100 .and. audits(1)%parcels == cloud%n - 100, 'two powders: an audit of each')
    call expect_close(audits(2)%made%values(1), 200.0_wp, 1.0e-14_wp, 'audit of the second: real particles made')
    call expect_close(audits(2)%asked%values(2), 200*11340*pi/6*(500*um)**3, 1.0e-12_wp, 'audit of the second: mass asked')
    call expect_close(audits(1)%made%values(5), audits(1)%asked%values(5), 1.0e-3_wp, 'audit of the first: Sauter mean')
    open (newunit=unit, status='scratch', action='readwrite')
    call write_audit(unit, audits(1))
    rewind (unit)
    do lines = 0, 100
      read (unit, '(a)', iostat=status, iomsg=message) line
      if (status /= 0) exit
      if (index(line, 'Sauter') > 0) call expect(index(line, 'um') > 0 .and. index(line, '542.963') > 0, &
                                                 'the table of the audit: '//trim(adjustl(line)))
    end do
    close (unit)
    call expect(lines == 13, 'the table of the audit has a line for each quantity')
  end subroutine two_powders

  !> A mass that does not fit: how much does is told.
  subroutine too_much()
    type(cloud_t) :: cloud
    type(outcome_t) :: outcome

    call make('log_normal', 'ssp', 1035.07_wp*um, 1.5e-3_wp, cloud, outcome)
    call expect(outcome%failed() .and. outcome%code == exit_input, 'a box that is too small is a mistake of the user')
    call expect(index(outcome%message, '&fill(bed): 1033 parcels, 0.0015 kg, do not fit') == 1, outcome%message)
    call expect(index(outcome%message, ' kg, do (solids fraction 0.5') > 0, 'and says how much fits')
  end subroutine too_much

  subroutine refusals()
    call expect_refusal('log_normal', 'ssw', [1.0e6_wp, 1.0e-3_wp], 'less than half a parcel')
    call expect_refusal('log_normal', 'ssp', [9.0e-3_wp, 1.0e-3_wp], 'wider than its box')
    call expect_refusal('log_normal', 'ssp', [700*um, 1.0e-3_wp], 'less than one particle')
    call expect_refusal('log_normal', 'ssw', [1.0_wp, 1.0e6_wp], 'would be')
    call expect_refusal('triangle', 'ssw', [1.0_wp, 1.0e-3_wp], 'not known')
  end subroutine refusals

  subroutine expect_refusal(distribution, weighting, size_and_mass, words)
    character(len=*), intent(in) :: distribution, weighting
    real(wp), intent(in) :: size_and_mass(2)  !< weight or diameter, mass [kg]
    character(len=*), intent(in) :: words     !< in the message

    type(cloud_t) :: cloud
    type(outcome_t) :: outcome

    call make(distribution, weighting, size_and_mass(1), size_and_mass(2), cloud, outcome)
    if (outcome%failed()) then
      call expect(index(outcome%message, words) > 0, 'refused: '//outcome%message)
    else
      call expect(.false., 'refused: '//words)
    end if
  end subroutine expect_refusal

end program test_psd_generator
